"""One start of a skill: ports, codes, compute, ownership, halting. Run through `run_skill`."""

from __future__ import annotations

import numpy as np
import pytest

from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions
from momantu_bt.robot import CAMERA_CARRIER
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, run_skill
from momantu_bt.world import TICK

FORWARD = BaseVelocity(0.5, 0.0)


class Drive(Skill):
    """Drives for some ticks, then ends as it is told."""

    ticks: int = In(3, doc="how many")
    ending: str = In("return", doc="return, fail, foreign or crash")
    failures = {"STUCK": "did not move"}
    uses = {"base"}

    def run(self, robot) -> Run:
        for _ in range(self.ticks):
            robot.command("base", FORWARD)
            yield "driving"
        if self.ending == "fail":
            raise Failure("STUCK", "did not move", moved=0.0)
        if self.ending == "foreign":
            raise Failure("PATH_BLOCKED", "a chair")
        if self.ending == "crash":
            raise ZeroDivisionError("by zero")


def stops(robot, actuator="base"):
    return [time for time, name, goal in robot.commands if name == actuator and goal is None]


@pytest.mark.parametrize(
    ("ending", "status", "code"),
    [
        ("return", "SUCCESS", None),
        ("fail", "FAILURE", "STUCK"),
        ("foreign", "FAILURE", "SKILL_ERROR"),
        ("crash", "FAILURE", "SKILL_ERROR"),
    ],
)
def test_however_a_skill_ends_what_it_owned_stops_once(ending, status, code):
    result = run_skill(Drive, inputs={"ending": ending})
    assert (result.status, result.code) == (status, code)
    assert len(stops(result.robot)) == 1
    assert result.robot.commands[-1][2] is None


def test_a_declared_failure_keeps_its_data():
    failure = run_skill(Drive, inputs={"ending": "fail"}).failure
    assert (failure.message, dict(failure.data)) == ("did not move", {"moved": 0.0})


def test_an_exception_becomes_skill_error_with_its_traceback():
    failure = run_skill(Drive, inputs={"ending": "crash"}).failure
    assert "ZeroDivisionError: by zero" in failure.message
    assert "in run" in failure.data["traceback"]


def test_an_undeclared_code_is_named_and_kept_as_the_cause():
    failure = run_skill(Drive, inputs={"ending": "foreign"}).failure
    assert "PATH_BLOCKED" in failure.message
    assert "STUCK" in failure.message
    assert failure.cause.code == "PATH_BLOCKED"


def test_a_halted_skill_stops_what_it_owned():
    result = run_skill(Drive, inputs={"ticks": 10_000}, max_time=1.0)
    assert result.status == "HALTED"
    assert result.duration == pytest.approx(1.0)
    assert len(stops(result.robot)) == 1


def test_halting_is_safe_at_any_yield_and_twice():
    for at in range(5):
        seen = []

        def halt(session, world, at=at, seen=seen):
            seen.append(session.status)
            if len(seen) > at:
                session.halt()
                session.halt()

        result = run_skill(Drive, on_tick=halt)
        assert len(stops(result.robot)) == 1


class Sloppy(Skill):
    """Yields while it is being closed, which Python forbids."""

    uses = {"base"}

    def run(self, robot) -> Run:
        try:
            while True:
                robot.command("base", FORWARD)
                yield "driving"
        finally:
            yield "cleaning up"


def test_a_skill_that_yields_while_closed_is_stopped_all_the_same():
    result = run_skill(Sloppy, max_time=0.5)
    assert len(stops(result.robot)) == 1
    assert "GeneratorExit" in result.failure.message


class Give(Skill):
    """Gives what it is told."""

    value: object = In(doc="what")
    given: float = Out(doc="it")
    failures = {}

    def run(self, robot) -> Run:
        if self.value is not None:
            self.given = self.value
        return
        yield ""


@pytest.mark.parametrize(
    ("value", "status", "code"),
    [
        (1.5, "SUCCESS", None),
        (2, "SUCCESS", None),
        ("text", "FAILURE", "WRONG_TYPE"),
        (True, "FAILURE", "WRONG_TYPE"),
        (None, "FAILURE", "SKILL_ERROR"),
    ],
)
def test_outputs_are_given_and_of_their_type(value, status, code):
    result = run_skill(Give, inputs={"value": value})
    assert (result.status, result.code) == (status, code)


def test_an_output_that_is_missing_is_named():
    assert "output 'given'" in run_skill(Give, inputs={"value": None}).failure.message


@pytest.mark.parametrize(
    ("inputs", "code", "words"),
    [
        ({"ticks": "three"}, "WRONG_TYPE", "expected int"),
        ({"speed": 3}, "SKILL_ERROR", "inputs: ticks, ending"),
    ],
)
def test_inputs_are_checked_at_the_start(inputs, code, words):
    failure = run_skill(Drive, inputs=inputs).failure
    assert failure.code == code
    assert words in failure.message


def test_a_required_input_that_is_missing_is_named():
    failure = run_skill(Give).failure
    assert (failure.code, failure.data["ports"]) == ("INPUT_MISSING", ["value"])


class NeedsMap(Skill):
    """Needs a service."""

    localization: object = Needs()

    def run(self, robot) -> Run:
        yield str(self.localization)


def test_a_service_that_does_not_run_is_named():
    failure = run_skill(NeedsMap, services={"planning_scene": object()}).failure
    assert failure.code == "SERVICE_MISSING"
    assert "localization" in failure.message
    assert "planning_scene" in failure.message


def test_services_are_attributes():
    assert run_skill(NeedsMap, services={"localization": "here"}).phases == ("here",)


class Think(Skill):
    """Thinks for a while."""

    budget: float = In(0.2, doc="how long")
    fails: bool = In(False, doc="whether the thought fails")
    thought: int = Out(doc="what came of it")

    def run(self, robot) -> Run:
        yield "before"
        try:
            self.thought = yield from compute(self.think, self.budget)
        except LookupError:
            self.thought = -1

    def think(self):
        if self.fails:
            raise LookupError("nothing found")
        return 7


@pytest.mark.parametrize("budget", [0.01, 0.05, 0.2, 1.0])
def test_thinking_takes_its_budget_of_simulated_time(budget):
    result = run_skill(Think, inputs={"budget": budget})
    assert result.outputs == {"thought": 7}
    ticks = max(1, round(budget / TICK + 0.49))
    assert result.duration == pytest.approx((1 + ticks) * TICK)


def test_what_a_thought_raises_is_raised_in_the_skill():
    assert run_skill(Think, inputs={"fails": True}).outputs == {"thought": -1}


@pytest.mark.parametrize("budget", [0.0, -1.0, float("nan")])
def test_thinking_is_never_free(budget):
    failure = run_skill(Think, inputs={"budget": budget}).failure
    assert failure.code == "SKILL_ERROR"
    assert "never free" in failure.message


class Odd(Skill):
    """Yields something that is neither a phase nor work."""

    def run(self, robot) -> Run:
        yield 3


class NoGenerator(Skill):
    """Has no yield."""

    def run(self, robot):
        return None


@pytest.mark.parametrize(("skill", "words"), [(Odd, "yielded 3"), (NoGenerator, "`yield`")])
def test_a_skill_that_is_written_wrongly_says_what_to_write(skill, words):
    failure = run_skill(skill).failure
    assert failure.code == "SKILL_ERROR"
    assert words in failure.message


class Grab(Skill):
    """Commands an actuator that it does not declare."""

    uses = {"base"}

    def run(self, robot) -> Run:
        robot.command("gripper", GripperCommand(0.0, 10.0))
        yield "never"


def test_an_undeclared_actuator_cannot_be_commanded():
    result = run_skill(Grab)
    assert result.code == "SKILL_ERROR"
    assert "'gripper'" in result.failure.message
    assert result.robot.commands == []


class Nod(Skill):
    """Moves whatever carries the camera."""

    uses = {CAMERA_CARRIER}

    def run(self, robot) -> Run:
        while abs(robot.state().position("tilt") - 0.3) > 1e-6:
            robot.command("head", JointPositions(("tilt",), (0.3,)))
            yield "nodding"


def test_camera_carrier_is_resolved_by_the_description():
    result = run_skill(Nod)
    assert result.status == "SUCCESS"
    assert result.phases == ("nodding",)
    assert result.robot.joints["tilt"] == pytest.approx(0.3)


class Random(Skill):
    """Draws a number."""

    drawn: float = Out(doc="it")

    def run(self, robot) -> Run:
        self.drawn = float(self.random.random())
        yield "drawing"


def test_random_numbers_depend_on_the_seed_alone():
    draws = [run_skill(Random, seed=seed).outputs["drawn"] for seed in (0, 0, 1)]
    assert draws[0] == draws[1] != draws[2]


class Lists(Skill):
    """Gives a list and an array."""

    items: tuple[int, ...] = Out(doc="a list")
    array: np.ndarray = Out(doc="an array")

    def run(self, robot) -> Run:
        yield "giving"
        self.items = [1, 2]
        self.array = np.zeros(3)


def test_outputs_are_immutable():
    outputs = run_skill(Lists).outputs
    assert outputs["items"] == (1, 2)
    with pytest.raises(ValueError, match="read-only"):
        outputs["array"][0] = 1.0


def test_a_dead_sensor_fails_the_skill_that_reads_it():
    class Read(Skill):
        """Reads the laser."""

        def run(self, robot) -> Run:
            robot.read("laser")
            yield "reading"

    robot = ScriptedRobot()
    robot.dead.add("laser")
    assert run_skill(Read, world=ScriptedWorld(robot)).code == "SENSOR_DEAD"


class Track(Skill):
    """Publishes a number at each tick, as it is told."""

    values: tuple[object, ...] = In(doc="one a tick")
    place: float = Out(doc="the newest", live=True)
    uses = {"base"}

    def run(self, robot) -> Run:
        for value in self.values:
            robot.command("base", FORWARD)
            self.place = value
            yield "tracking"


def test_a_live_output_that_does_not_fit_fails_at_once():
    result = run_skill(Track, inputs={"values": (1.0, "two", 3.0, 4.0)})
    assert (result.status, result.code) == ("FAILURE", "WRONG_TYPE")
    assert "port place got 'two'" in result.failure.message
    assert len([goal for _, _, goal in result.robot.commands if goal is not None]) == 2
    assert len(stops(result.robot)) == 1


def test_live_outputs_that_fit_are_given_as_the_port_takes_them():
    result = run_skill(Track, inputs={"values": (1.0, 2, 3)})
    assert result.status == "SUCCESS"
    assert result.outputs == {"place": 3.0}
    assert type(result.outputs["place"]) is float


class Reports(Skill):
    """Report a number, then fail."""

    path: str = In("none", may_be_empty=True, doc="a key that may have no value")
    number: int = Out(doc="a code", live=True)
    late: int = Out(doc="written on SUCCESS only")

    failures = {"BROKEN": "it breaks"}
    said = ""

    def run(self, robot) -> Run:
        Reports.said = self.path
        self.number = 205
        self.late = 1
        raise Failure("BROKEN", "it broke")
        yield ""


class Reads(Skill):
    """Remember what is read."""

    number: int = In(doc="a code")
    late: int = In(0, may_be_empty=True, doc="it may be missing")
    seen = ()

    def run(self, robot) -> Run:
        Reads.seen = (self.number, self.late)
        return
        yield ""


def test_a_failing_skill_writes_its_live_outputs_alone(run_yaml) -> None:
    report = run_yaml(
        """
trees:
  Main:
    fallback:
      - reports: {path: $later, number: $code, late: $late}
      - reads: {number: $code, late: $late}
      - set: {key: $later, value: x}
values: {code: 0}
""",
        Reports,
        Reads,
    )
    assert report.status == "SUCCESS", report.failure
    assert Reads.seen == (205, 0)
    assert Reports.said == "none"  # nothing has written $later yet


def test_an_input_that_may_be_empty_needs_a_default() -> None:
    with pytest.raises(TypeError, match="needs a default"):
        In(may_be_empty=True, doc="x")
