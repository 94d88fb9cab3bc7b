"""Services: their order, when they are due, and that they look but do not touch."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.services import ServiceCycleError, Services, each_once, in_order
from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity
from momantu_bt.running.launch import LaunchError
from momantu_bt.service import Service
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.testing import ManualClock, ScriptedRobot, ScriptedWorld, scripted_site
from momantu_bt.tree.problems import TreeError
from momantu_bt.world import TICK


def kind(*needs, rate=20.0):
    class Some(Service):
        """Keeps when it was updated."""

        def start(self, context):
            self.context, self.updates = context, []

        def update(self, robot, now):
            self.updates.append(now)

    Some.needs, Some.rate = needs, rate
    return Some


@given(
    edges=st.sets(st.tuples(st.integers(0, 6), st.integers(0, 6))), asked=st.sets(st.integers(0, 6))
)
def test_each_service_comes_after_what_it_needs_and_nothing_is_started_in_vain(edges, asked):
    graph = {i: sorted(b for a, b in edges if a == i and b < i) for i in range(7)}
    kinds = {str(i): kind(*map(str, needs)) for i, needs in graph.items()}
    ordered = list(in_order(map(str, sorted(asked)), kinds.__getitem__))
    wanted, waiting = set(), sorted(asked)
    while waiting:
        one = waiting.pop()
        wanted.add(str(one))
        waiting += graph[one]
    assert set(ordered) == wanted
    assert len(ordered) == len(wanted)
    for name in ordered:
        assert all(ordered.index(need) < ordered.index(name) for need in kinds[name].needs)


@pytest.mark.parametrize("length", [1, 2, 4])
def test_a_circle_of_needs_is_shown(length):
    names = [f"s{i}" for i in range(length)]
    kinds = {name: kind(names[(i + 1) % length]) for i, name in enumerate(names)}
    with pytest.raises(ServiceCycleError) as circle:
        in_order(["s0"], kinds.__getitem__)
    assert str(circle.value) == " needs ".join([*names, "s0"])


def updates(rate, ticks):
    service = kind(rate=rate)()
    services = Services({"some": service}, Actuators(ScriptedRobot()))
    robot = ScriptedRobot()
    services.start(
        scripted_site(), FrameBuffer(robot.description.kinematics()), ManualClock(), seed=0
    )
    for tick in range(1, ticks + 1):
        services.update(tick * TICK)
    return service.updates


@given(rate=st.floats(0.5, 20.0), ticks=st.integers(1, 400))
def test_a_service_keeps_its_rate_however_it_falls_between_the_ticks(rate, ticks):
    times = updates(rate, ticks)
    assert times[0] == TICK
    for count, time in enumerate(times):
        due = TICK + count / rate
        assert due - 1e-6 <= time < due + TICK + 1e-6
    assert ticks * TICK < TICK + len(times) / rate + TICK + 1e-6


@pytest.mark.parametrize("rate", [20.0, 25.0, 1000.0])
def test_a_service_is_never_updated_twice_in_a_tick(rate):
    assert len(updates(rate, 50)) == 50


def test_a_service_cannot_command_the_robot(run_yaml):
    class Meddling(kind()):
        """Drives off."""

        def update(self, robot, now):
            robot.command("base", BaseVelocity(1.0, 0.0))

    class Asking(Skill):
        """Needs it."""

        meddling: Meddling = Needs()

        def run(self, robot) -> Run:
            yield "asking"

    world = ScriptedWorld()
    report = run_yaml("trees: {Main: asking}", Asking, services={"meddling": Meddling}, world=world)
    assert report.status == "ERROR"
    assert "PermissionError: meddling commands 'base'" in report.error
    assert not any(isinstance(goal, BaseVelocity) for _, _, goal in world.robot.commands)


@pytest.mark.parametrize("installed", [{}, {"eyes": kind("radio")}])
def test_a_service_that_is_not_installed(run_yaml, installed):
    class Asking(Skill):
        """Needs one, which needs another."""

        needs = ("eyes",)

        def run(self, robot) -> Run:
            yield "asking"

    missing = "radio" if installed else "eyes"
    listed = "installed services: eyes" if installed else "there are no installed services"
    with pytest.raises(LaunchError) as error:
        run_yaml("trees: {Main: asking}", Asking, services=installed, world=ScriptedWorld())
    said = f"asking needs the service {missing!r}, which is not installed; {listed}"
    assert str(error.value) == said


@pytest.mark.parametrize("sense", ["laser", "lidar"])
def test_a_robot_without_the_sensor_that_a_service_needs_is_refused(run_yaml, sense):
    class Asking(Skill):
        """Needs a service that needs a sensor."""

        needs = ("eyes",)

        def run(self, robot) -> Run:
            yield "asking"

    eyes = kind()
    eyes.senses = (sense,)
    tree, world = "trees: {Main: asking}", ScriptedWorld()
    if sense == "laser":
        assert run_yaml(tree, Asking, services={"eyes": eyes}, world=world).status == "SUCCESS"
        return
    with pytest.raises(TreeError, match="asking needs a lidar, and the robot small has none"):
        run_yaml(tree, Asking, services={"eyes": eyes}, world=world)


def test_a_service_gets_the_sites_parameters_and_a_random_of_its_own():
    first, second = kind()(), kind()()
    robot, site = ScriptedRobot(), scripted_site()
    draws = []
    for seed in (4, 4, 5):
        services = Services({"first": first, "second": second}, Actuators(robot))
        services.start(site, FrameBuffer(robot.description.kinematics()), ManualClock(), seed)
        draws.append([one.context.random.random() for one in (first, second)])
    assert draws[0] == draws[1]
    assert len({*draws[0], *draws[2]}) == 4
    assert first.context.other("second") is second
    assert dict(first.context.parameters) == {}
    with pytest.raises(KeyError):
        first.context.other("third")


class Battery(Service):
    """Its charge falls with time."""

    rate = 20.0
    publishes = {"charge": float}
    needs = ()

    def start(self, context):
        self.charge = 1.0

    def update(self, robot, now):
        self.charge -= 0.1

    def published(self):
        return {"charge": self.charge}


@pytest.mark.parametrize(
    "tree",
    [
        "trees: {Main: [{wait: 0.3 s}, {condition: $@battery.charge < 0.9}]}",
        "trees: {Main: [{wait: 0.3 s}, {script: $low := $@battery.charge < 0.9}]}",
        "trees: {Main: [{wait: 1 s, skip_if: $@battery.charge < 1.0}]}",
        "trees: {Main: [{wait: $@battery.charge}]}",
        'trees: {Main: [{ask: {question: "${@battery.charge} left?", default: a, answer: $a}}]}',
        "trees: {Main: [{Below: {left: $@battery.charge}}],"
        " Below: {inputs: {left: number}, sequence: [{condition: $left < 1.0}]}}",
        "trees: {Main: [Below], Below: {inputs: {left: {type: any, default: $@battery}},"
        " sequence: [{condition: $left.charge < 1.0}]}}",
    ],
)
def test_a_service_that_only_the_tree_reads_is_started(run_yaml, tree):
    report = run_yaml(tree, services={"battery": Battery}, world=ScriptedWorld())
    assert report.status == "SUCCESS", report.failure


def test_what_a_service_needs_is_started_before_it(run_yaml):
    class Gauge(Battery):
        """Needs the battery."""

        needs = ("battery",)

        def start(self, context):
            super().start(context)
            assert context.other("battery").charge == 1.0

    tree = "trees: {Main: [{condition: $@gauge.charge < 1.0}]}"
    services = {"gauge": Gauge, "battery": Battery}
    assert run_yaml(tree, services=services, world=ScriptedWorld()).status == "SUCCESS"


def test_a_service_that_nothing_reads_is_not_started(run_yaml):
    class Broken(Battery):
        """Cannot start."""

        def start(self, context):
            raise AssertionError

    for tree in (
        "trees: {Main: [{wait: 0.1 s}]}",
        "values: {battery: 3}\ntrees: {Main: [{condition: $@battery == 3}]}",
        "trees: {Main: [{script: $battery := 3}, {condition: $@battery == 3}]}",
        "trees: {Main: [{script: $battery := 3}, Below], Below: [{condition: $@battery == 3}]}",
        "trees: {Main: [{condition: $@battery == 3, disabled: true}, {wait: 0.1 s}]}",
    ):
        report = run_yaml(tree, services={"battery": Broken}, world=ScriptedWorld())
        assert report.status == "SUCCESS", (tree, report.failure, report.error)


def test_without_a_world_the_run_says_that_the_service_needs_one(run_yaml):
    tree = "trees: {Main: [{condition: $@battery.charge < 1}]}"
    with pytest.raises(LaunchError, match=r"reads \$@battery, which a service publishes"):
        run_yaml(tree, services={"battery": Battery}, world="none")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"particle": 3}, "localization has no tunable 'particle'; did you mean"),
        ({"move": "3 kg"}, "localization.move: '3 kg' is a mass; expected a length"),
        (5, "sets the service 'localization' to 5; expected a mapping"),
    ],
)
def test_a_site_that_sets_a_service_wrongly_is_refused_before_the_run(run_yaml, given, said):
    site = replace(scripted_site(), services={"localization": given})
    tree = "trees: {Main: [{condition: $@localization.charge > 0}]}"
    world = ScriptedWorld(site=site)
    with pytest.raises(LaunchError) as error:
        run_yaml(tree, services={"localization": Battery}, world=world)
    assert said in str(error.value)


def taking(*names, needs=()):
    """A service that takes the place of others."""
    made = kind(*needs)
    made.replaces, made.charts = names, True
    made.publishes = {"level": float}
    made.published = lambda self: {"level": 2.0}
    return made


def test_a_service_that_replaces_another_is_under_its_name_too_and_is_made_once():
    kinds = {"map": kind(), "user": kind("map"), "own": taking("map")}
    for asked in (["user", "own"], ["own", "user"], ["map", "own", "user"]):
        ordered = in_order(asked, kinds.__getitem__)
        assert ordered["map"] is ordered["own"] is kinds["own"]
        assert list(ordered).index("own") < list(ordered).index("user")
        running = each_once(ordered, lambda name, made: made())
        assert running["map"] is running["own"]


def test_without_the_one_that_replaces_nothing_is_replaced():
    kinds = {"map": kind(), "user": kind("map"), "own": taking("map")}
    assert in_order(["user"], kinds.__getitem__)["map"] is kinds["map"]


def test_it_is_updated_once_a_period_and_the_run_is_told_no_map(run_tree):
    own = taking("localization")
    site = scripted_site(places={"dock": Pose2D(1.0, 0.0)})
    seen = []

    class Look(Skill):
        """Look at the service that stands for the old one."""

        localization: Any = Needs()
        own: Any = Needs()
        failures = {}

        def run(self, robot) -> Run:
            """Note it."""
            seen.extend([self.localization, self.own, self.site])
            yield "look"

    tree = """
        momantu_bt: 1
        values: {level: 0.0}
        trees: {Main: [{look: {}}, {wait: 1 s}, {condition: $@own.level > 1}]}
        """
    report = run_tree(tree, skills={"look": Look}, services={"own": own}, site=site)
    assert report.status == "SUCCESS", report.failure
    first, second, told = seen
    assert first is second
    gaps = [b - a for a, b in itertools.pairwise(first.updates)]
    assert min(gaps) > 0.04
    assert (told.map_file, dict(told.places), dict(told.surfaces)) == (None, {}, {})
