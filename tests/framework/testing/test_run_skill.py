"""`run_skill` runs a skill as a tree does: the same clock, services, phases, ends and commands."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import BaseVelocity, JointPositions
from momantu_bt.service import Service
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.testing import ManualClock, ScriptedRobot, ScriptedWorld, run_skill, scripted_site
from momantu_bt.world import TICK


class Wander(Skill):
    """Drives and thinks by chance."""

    steps: int = In(5, doc="how many")
    sum: float = Out(doc="of all draws")
    uses = {"base"}

    def run(self, robot) -> Run:
        total = 0.0
        for index in range(self.steps):
            speed = float(self.random.uniform(-0.5, 0.5))
            total += speed
            robot.command("base", BaseVelocity(speed, 0.0))
            yield f"step {index}"
            if speed > 0.2:
                total += yield from compute(lambda: 1.0, budget=0.12)
        self.sum = total


@given(seed=st.integers(0, 50), steps=st.integers(0, 6))
def test_the_same_seed_gives_the_same_commands_phases_and_outputs(seed, steps):
    first, second = (run_skill(Wander, inputs={"steps": steps}, seed=seed) for _ in range(2))
    assert first.outputs == second.outputs
    assert first.phases == second.phases == tuple(f"step {i}" for i in range(steps))
    assert first.robot.commands == second.robot.commands
    assert first.duration == pytest.approx((first.ticks - 1) * TICK)


class Count(Skill):
    """Yields now and then the same phase."""

    phases: tuple[str, ...] = In(doc="what to say")

    def run(self, robot) -> Run:
        yield from self.phases


@given(said=st.lists(st.sampled_from(["a", "b"]), max_size=8))
def test_phases_are_told_once_per_change(said):
    result = run_skill(Count, inputs={"phases": tuple(said)})
    changes = [phase for i, phase in enumerate(said) if i == 0 or said[i - 1] != phase]
    assert result.phases == tuple(changes)
    assert result.ticks == len(said) + 1


@given(ticks=st.integers(1, 40))
def test_a_skill_gets_exactly_the_time_that_is_allowed(ticks):
    result = run_skill(Count, inputs={"phases": ("on",) * 100}, max_time=ticks * TICK)
    assert (result.status, result.ticks) == ("HALTED", ticks)
    assert result.code is None


class Partly(Skill):
    """Gives one output, then fails."""

    half: int = Out(doc="the first")
    failures = {"TIRED": "cannot go on"}

    def run(self, robot) -> Run:
        self.half = 1
        yield "giving"
        raise Failure("TIRED", "no more", energy=0.1)


def test_a_skill_that_fails_gives_nothing_and_explains_itself():
    result = run_skill(Partly)
    assert (result.status, result.code, dict(result.outputs)) == ("FAILURE", "TIRED", {})
    assert result.skill.half == 1
    assert "TIRED, no more" in result.explain()
    assert "energy" in result.explain()


class Beacon(Service):
    """Knows where odom lies in the map."""

    rate = 5.0

    def start(self, context):
        self.context, self.times = context, []

    def update(self, robot, now):
        self.times.append(now)
        self.context.frames.set_map_from_odom(Transform((len(self.times), 0.0, 0.0)), now)


class Watch(Skill):
    """Waits, then says where it is."""

    seconds: float = In(1.0, doc="how long")
    x: float = Out(doc="of the base in the map, m")
    beacon: Beacon = Needs()
    plain: str = Needs()

    def run(self, robot) -> Run:
        until = self.clock.now() + self.seconds
        while self.clock.now() < until - 1e-9:
            yield f"with {self.plain}"
        self.x = float(self.frames.lookup("map", "base_link").position[0])


def test_services_run_beside_the_skill_at_their_rate_and_others_are_used_as_they_are():
    beacon = Beacon()
    result = run_skill(Watch, services={"beacon": beacon, "plain": "something"})
    assert result.phases == ("with something",)
    assert beacon.times == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert result.outputs["x"] == pytest.approx(6.0)


def test_a_second_skill_goes_on_in_the_world_of_the_first():
    world, beacon = ScriptedWorld(), Beacon()
    services = {"beacon": beacon, "plain": "something"}
    first = run_skill(Watch, services=services, world=world)
    second = run_skill(
        Watch, services=services, world=world, frames=first.skill.frames, inputs={"seconds": 0.5}
    )
    assert second.outputs["x"] > first.outputs["x"]
    assert second.duration == pytest.approx(0.5)
    assert world.now() == pytest.approx(1.5)


def test_a_skill_can_be_shown_another_place_in_the_map():
    class Place(Skill):
        """Says where it is."""

        x: float = Out(doc="m")

        def run(self, robot) -> Run:
            yield "looking"
            self.x = float(self.frames.lookup("map", "base_link").position[0])

    robot = ScriptedRobot(base=Pose2D(1.0, 0.0, 0.0))
    result = run_skill(Place, robot=robot, map_from_odom=Transform((10.0, 0.0, 0.0)))
    assert result.outputs["x"] == pytest.approx(11.0)
    assert run_skill(Place, robot=ScriptedRobot()).outputs["x"] == 0.0


def test_what_is_called_after_each_tick_sees_the_skill_and_may_break():
    seen = []

    def look(session, world):
        seen.append((session.phase, round(world.now() / TICK)))
        if session.phase == "b":
            raise AssertionError("b is not allowed")

    robot = ScriptedRobot()
    with pytest.raises(AssertionError, match="b is not allowed"):
        run_skill(Count, robot=robot, inputs={"phases": ("a", "b", "c")}, on_tick=look)
    assert seen == [("a", 0), ("b", 1)]


def test_an_exception_of_the_test_still_stops_the_robot():
    class Drive(Skill):
        """Drives on."""

        uses = {"base", "head"}

        def run(self, robot) -> Run:
            while True:
                robot.command("base", BaseVelocity(0.5, 0.0))
                robot.command("head", JointPositions(("pan",), (0.2,)))
                yield "driving"

    def explode(robot):
        raise OSError("gone")

    world = ScriptedWorld(on_step=explode)
    with pytest.raises(OSError, match="gone"):
        run_skill(Drive, world=world)
    assert [(name, goal) for _, name, goal in world.robot.commands][-2:] == [
        ("base", None),
        ("head", None),
    ]


def test_a_worlds_clock_starts_at_nothing_though_its_robot_is_older():
    robot = ScriptedRobot()
    robot.advance(3.0)
    world = ScriptedWorld(robot, scripted_site(places={"dock": Pose2D(1.0, 0.0, 0.0)}))
    assert world.now() == 0.0
    world.step()
    assert world.now() == pytest.approx(TICK)
    assert world.site.known_places() == ("dock", "table_a", "table_b")
    world.close()
    world.close()
    assert world.closed


def test_a_manual_clock_moves_when_it_is_told_to():
    clock = ManualClock(1.0)
    assert clock.now() == clock.now() == 1.0
    clock.advance(0.5)
    assert clock.now() == 1.5
