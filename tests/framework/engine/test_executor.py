"""A whole run: order of things, how it ends, that everything stops, and what the report says."""

from __future__ import annotations

import itertools
import json
import os
import signal
import threading
import time
from typing import Any

import pytest

from momantu_bt.engine.executor import SETTLE
from momantu_bt.failure import Failure
from momantu_bt.geometry import Transform
from momantu_bt.messages import BaseVelocity
from momantu_bt.record.film import FilmObserver
from momantu_bt.running.launch import LaunchError
from momantu_bt.service import Service
from momantu_bt.skill import In, Needs, Out, Run, Skill
from momantu_bt.testing import ScriptedRobot, ScriptedWorld
from momantu_bt.world import TICK, Verdict


class Drive(Skill):
    """Drives for some ticks."""

    ticks: int = In(10, doc="how many")
    uses = {"base"}

    def run(self, robot) -> Run:
        for _ in range(self.ticks):
            robot.command("base", BaseVelocity(0.5, 0.0))
            yield "driving"


class Crash(Skill):
    """Raises something undeclared on its third tick."""

    def run(self, robot) -> Run:
        yield "one"
        yield "two"
        raise ZeroDivisionError("by zero")


class Sample(Skill):
    """Draws random numbers and reads the place."""

    drawn: float = Out(doc="a number")

    def run(self, robot) -> Run:
        yield "drawing"
        self.drawn = float(self.random.random()) + robot.state().linear


class Localization(Service):
    """Believes the odometry."""

    rate = 10.0
    publishes = {"quality": float}

    def start(self, context):
        self.context, self.updates = context, []

    def update(self, robot, now):
        self.updates.append(now)
        self.context.frames.set_map_from_odom(Transform(), now)

    def published(self):
        return {"quality": 0.5 + len(self.updates)}


class Scene(Service):
    """Needs localization."""

    needs = ("localization",)

    def start(self, context):
        self.started_after = context.other("localization").context is not None

    def update(self, robot, now):
        pass


class Where(Skill):
    """Looks up where the base is in the map."""

    x: float = Out(doc="m")
    planning_scene: Scene = Needs()

    def run(self, robot) -> Run:
        yield "looking"
        self.x = float(self.frames.lookup("map", "base_link").position[0])


SERVICES = {"localization": Localization, "planning_scene": Scene}
DRIVE = """
trees:
  Main:
    - drive: {ticks: 10}
    - sample: {drawn: $n}
"""
PARALLEL = """
trees:
  Main:
    parallel: [{drive: {ticks: 1000}}, crash]
"""


def test_a_crash_below_a_parallel_fails_that_leaf_and_stops_its_siblings(run_yaml):
    world = ScriptedWorld()
    report = run_yaml(PARALLEL, Drive, Crash, world=world)
    assert (report.status, report.failure.code) == ("FAILURE", "SKILL_ERROR")
    assert report.sim_time_s == pytest.approx(0.15)
    assert world.robot.linear == 0.0
    assert [n.failures for n in report.nodes if n.type == "crash"] == [1]


def test_everything_stands_still_when_a_run_is_over(run_yaml):
    world = ScriptedWorld()
    report = run_yaml(DRIVE, Drive, Sample, world=world)
    assert report.status == "SUCCESS"
    assert world.now() == pytest.approx(report.sim_time_s + SETTLE)
    assert world.robot.linear == 0.0
    last = {actuator: goal for _, actuator, goal in world.robot.commands}
    assert last == dict.fromkeys(world.robot.description.actuators)


def test_services_start_in_the_order_of_their_needs_and_update_at_their_rate(run_yaml):
    made = []

    class Watched(Localization):
        """The same, kept for the test."""

        def start(self, context):
            super().start(context)
            made.append(self)

    text = (
        "trees: {Main: [{where: {x: $x}}, {wait: 1 s}, {script: '$q := $@localization.quality'}]}"
    )
    services = {"localization": Watched, "planning_scene": Scene}
    report = run_yaml(text, Where, services=services)
    assert report.status == "SUCCESS"
    assert report.blackboard["x"] == 0.0
    updates = made[0].updates
    assert [b - a for a, b in itertools.pairwise(updates)] == pytest.approx(
        [0.1] * (len(updates) - 1)
    )
    assert report.blackboard["q"] == 0.5 + len(updates)


def test_published_keys_are_read_only(run_yaml):
    text = "trees: {Main: [where, {script: '$@localization := 3'}]}"
    report = run_yaml(text, Where, services=SERVICES)
    assert report.failure.code == "SCRIPT_ERROR"
    assert "read-only" in report.failure.message


class BrokenService(Localization):
    """Breaks after half a second."""

    def update(self, robot, now):
        if now > 0.5:
            raise RuntimeError("lost the map")
        super().update(robot, now)


class DriveNeeding(Drive):
    """Drives, and needs localization."""

    localization: Localization = Needs()


def test_an_exception_in_a_service_stops_everything_with_status_error(run_yaml):
    world = ScriptedWorld()
    services = {"localization": BrokenService}
    report = run_yaml(
        "trees: {Main: [{drive_needing: {ticks: 1000}}]}",
        DriveNeeding,
        world=world,
        services=services,
    )
    assert (report.status, report.exit_code) == ("ERROR", 4)
    assert "lost the map" in report.error
    assert world.robot.commands[-1][2] is None


def test_an_exception_in_the_world_stops_everything_with_status_error(run_yaml):
    def explode(robot):
        if robot.now() > 0.5:
            raise OSError("the simulator is gone")

    world = ScriptedWorld(on_step=explode)
    report = run_yaml("trees: {Main: [{drive: {ticks: 1000}}]}", Drive, world=world)
    assert report.status == "ERROR"
    assert "the simulator is gone" in report.error
    assert report.success is None


def test_a_run_that_takes_too_long_fails_with_timeout(run_yaml):
    report = run_yaml("trees: {Main: [{drive: {ticks: 1000}}]}", Drive, max_time=2.0)
    assert (report.status, report.failure.code) == ("FAILURE", "TIMEOUT")
    assert report.failure.cause.node == "drive"
    assert report.sim_time_s == pytest.approx(2.0)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_mid_motion_brakes_and_reports(run_yaml, number):
    def interrupt(robot):
        if abs(robot.now() - 1.0) < TICK / 2:
            os.kill(os.getpid(), number)

    world = ScriptedWorld(on_step=interrupt)
    before = signal.getsignal(signal.SIGINT)
    report = run_yaml("trees: {Main: [{drive: {ticks: 1000}}]}", Drive, world=world)
    assert (report.status, report.exit_code) == ("INTERRUPTED", 130)
    assert world.robot.linear == 0.0
    assert signal.getsignal(signal.SIGINT) == before


def test_a_second_signal_ends_it_at_once_and_is_reported_too(run_yaml):
    def interrupt(robot):
        if abs(robot.now() - 1.0) < TICK / 2 or robot.now() > 1.2:
            os.kill(os.getpid(), signal.SIGINT)

    world = ScriptedWorld(on_step=interrupt)
    report = run_yaml("trees: {Main: [{drive: {ticks: 1000}}]}", Drive, world=world)
    assert report.status == "INTERRUPTED"
    assert world.now() < 1.5


def test_a_run_works_outside_the_main_thread(run_yaml):
    reports = []
    thread = threading.Thread(target=lambda: reports.append(run_yaml(DRIVE, Drive, Sample)))
    thread.start()
    thread.join()
    assert reports[0].status == "SUCCESS"


def verdict(success):
    return lambda robot: Verdict(success, () if success else ("the can fell",), {"tilt": 0.1})


@pytest.mark.parametrize(
    ("tree", "referee", "exit_code"),
    [("succeed", True, 0), ("succeed", False, 1), ("always_failure", True, 1)],
)
def test_the_exit_code_joins_the_tree_and_the_referee(run_yaml, tree, referee, exit_code):
    world = ScriptedWorld(verdict_of=verdict(referee))
    report = run_yaml(f"trees: {{Main: [{tree}]}}", world=world)
    assert (report.exit_code, report.success) == (exit_code, referee)
    assert report.unmet == (() if referee else ("the can fell",))


def test_without_a_referee_the_tree_decides(run_yaml):
    report = run_yaml("trees: {Main: [succeed]}")
    assert (report.success, report.exit_code) == (None, 0)


def fingerprint(run_yaml, **options):
    return run_yaml(DRIVE, Drive, Sample, **options).fingerprint


def test_the_same_seed_gives_the_same_fingerprint_and_another_one_does_not(run_yaml):
    prints = [fingerprint(run_yaml, seed=seed) for seed in (3, 3, 4)]
    assert prints[0] == prints[1] != prints[2]


def test_observers_and_referee_leave_the_fingerprint_alone(run_yaml, tmp_path):
    plain = fingerprint(run_yaml)
    judged = fingerprint(run_yaml, world=ScriptedWorld(verdict_of=verdict(True)))

    def watch(run):
        return [FilmObserver(run.world.open_video(tmp_path / "film.txt", "title"))]

    watched = fingerprint(run_yaml, watch=watch, record=tmp_path / "record")
    assert watched == judged == plain


def test_another_start_gives_another_fingerprint(run_yaml):
    robot = ScriptedRobot(joints={"lift": 0.1})
    assert fingerprint(run_yaml, world=ScriptedWorld(robot)) != fingerprint(run_yaml)


def test_a_tree_with_skills_needs_a_world(run_yaml):
    with pytest.raises(LaunchError, match="needs a world for drive"):
        run_yaml("trees: {Main: [drive]}", Drive, world="none")


def test_a_tree_without_skills_runs_without_a_world(run_yaml):
    report = run_yaml("trees: {Main: [{wait: 1 s}]}", world="none")
    assert (report.status, report.world) == ("SUCCESS", None)
    assert report.sim_time_s == pytest.approx(1.05)


def test_realtime_waits_for_the_clock(run_yaml, monkeypatch):
    wall = [100.0]
    monkeypatch.setattr(time, "perf_counter", lambda: wall[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: wall.append(wall.pop() + seconds))
    report = run_yaml("trees: {Main: [{wait: 0.3 s}]}", world="none", realtime=True)
    # the last tick, which ends the run, is not waited for
    assert wall[0] - 100.0 == pytest.approx(report.sim_time_s - TICK)


def test_the_report_counts_simulated_seconds_and_runs(run_yaml):
    report = run_yaml(DRIVE, Drive, Sample)
    drive = next(n for n in report.nodes if n.name == "drive")
    assert (drive.runs, drive.failures, drive.ticks) == (1, 0, 11)
    assert drive.seconds == pytest.approx(0.5)
    assert report.ticks == 12
    assert json.loads(json.dumps(report.as_dict()))["status"] == "SUCCESS"


def test_a_failure_before_the_first_yield_is_a_failure(run_yaml):
    class Refuse(Skill):
        """Does not even begin."""

        failures = {"NO": "no"}

        def run(self, robot) -> Run:
            raise Failure("NO", "I will not")
            yield ""

    assert run_yaml("trees: {Main: [refuse]}", Refuse).failure.message == "I will not"


def test_a_reactive_node_asks_all_its_conditions_on_each_tick(run_yaml):
    steps = ", ".join(["{condition: '$n > 0'}"] * 40)
    text = f"values: {{n: 1}}\ntrees: {{Main: {{reactive_sequence: [{steps}, {{wait: 5 s}}]}}}}"
    report = run_yaml(text, world="none")
    assert report.ticks == 101
    assert report.nodes[1].ticks == 101


class Nothing(Skill):
    """Finds nothing."""

    found: float | None = Out(doc="None if there is nothing")

    def run(self, robot) -> Run:
        self.found = None
        return
        yield ""


def test_an_output_without_a_value_replaces_the_one_before(run_yaml) -> None:
    boards: list[Any] = []
    text = """trees:
  Main:
    - set: {key: $spot, value: 3}
    - nothing: {found: $spot}
"""

    def watch(run):
        boards.append(run.built.board)
        return []

    assert run_yaml(text, Nothing, watch=watch).status == "SUCCESS"
    assert boards[0].cell("spot").value is None
