"""A skill that calls skills: outputs, phases, failures, owners of actuators, halts, seeds."""

from __future__ import annotations

import pytest

from momantu_bt.failure import CALL_FAILED, Failure
from momantu_bt.messages import BaseVelocity, GripperCommand
from momantu_bt.record.reader import read_record
from momantu_bt.replay.recheck import recheck
from momantu_bt.running.calls import CallError, check_calls
from momantu_bt.skill import In, Needs, Out, Run, Skill, compute
from momantu_bt.testing import ScriptedRobot, run_skill
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry

CLOSED: list[str] = []


class Roll(Skill):
    """Roll forward for some ticks, and leave the base moving at the end."""

    ticks: int = In(3, doc="how many")
    drawn: float = Out(doc="a random number")
    failures = {"BLOCKED": "it was asked to roll for no time"}
    uses = {"base"}

    def run(self, robot) -> Run:
        """Roll."""
        self.drawn = float(self.random.uniform())
        try:
            if self.ticks == 0:
                raise Failure("BLOCKED", "no tick to roll in", ticks=0)
            for _ in range(self.ticks):
                robot.command("base", BaseVelocity(0.1, 0.0))
                yield "rolling"
        finally:
            CLOSED.append("roll")


class Twice(Skill):
    """Roll twice; the calls are by name."""

    ticks: int = In(3, doc="how many each time")
    drawn: tuple[float, ...] = Out(doc="the random numbers of both")
    uses = {"base"}
    calls = ("roll",)

    def run(self, robot) -> Run:
        """Roll and roll again."""
        first = yield from self.call("roll", ticks=self.ticks)
        yield "between"
        second = yield from self.call("roll", ticks=self.ticks)
        self.drawn = first["drawn"], second["drawn"]


SKILLS = {"roll": Roll}


def run(kind, **options):
    return run_skill(kind, skills={**SKILLS, **options.pop("skills", {})}, **options)


def made(**attributes):
    """A subclass of Twice with other attributes."""
    return type("Other", (Twice,), {"__doc__": "Other.", **attributes})


def test_outputs_come_back_and_phases_carry_the_name():
    result = run(Twice)
    assert result.status == "SUCCESS", result.explain()
    assert result.phases == ("roll/rolling", "between", "roll/rolling")
    assert len(result.outputs["drawn"]) == 2


def test_each_call_has_random_numbers_of_its_own_and_they_follow_the_seed():
    first, again, other = (run(Twice, seed=seed).outputs["drawn"] for seed in (1, 1, 2))
    assert first == again
    assert len({*first, *other}) == 4


def test_what_the_called_skill_moved_stops_at_its_end():
    robot = ScriptedRobot()
    seen = []
    run(Twice, robot=robot, on_tick=lambda s, w: seen.append((s.phase, robot.commands[-1][2])))
    assert ("between", None) in seen


def test_a_code_that_the_caller_declares_passes_through_with_its_cause():
    kind = made(failures={"BLOCKED": "it cannot roll"})
    failure = run(kind, inputs={"ticks": 0}).failure
    assert (failure.code, failure.message, failure.data["ticks"]) == (
        "BLOCKED",
        "no tick to roll in",
        0,
    )
    assert (failure.cause.code, failure.cause.node, failure.cause.node_type) == (
        "BLOCKED",
        "roll",
        "roll",
    )


def test_another_code_becomes_call_failed_with_its_cause():
    failure = run(Twice, inputs={"ticks": 0}).failure
    assert failure.code == CALL_FAILED
    assert "roll failed with BLOCKED" in failure.message
    assert failure.cause.code == "BLOCKED"


def test_the_caller_can_catch_the_failure_and_give_its_own():
    def run_it(self, robot):
        try:
            yield from self.call("roll", ticks=0)
        except Failure as failure:
            raise Failure("GIVEN_UP", f"because of {failure.code}") from failure

    failure = run(made(run=run_it, failures={"GIVEN_UP": "it did not work"})).failure
    assert [link.code for link in failure.chain()] == ["GIVEN_UP", "BLOCKED"]


def test_an_exception_of_the_called_skill_is_the_cause():
    class Broken(Roll):
        """Break."""

        def run(self, robot):
            yield "starting"
            raise ZeroDivisionError("of nothing")

    failure = run(Twice, skills={"roll": Broken}).failure
    assert [link.code for link in failure.chain()] == [CALL_FAILED, "SKILL_ERROR"]
    assert "ZeroDivisionError" in failure.cause.data["traceback"]


def test_a_halt_reaches_the_called_skill():
    CLOSED.clear()
    robot = ScriptedRobot()
    result = run(Twice, robot=robot, inputs={"ticks": 1000}, max_time=0.3)
    assert result.status == "HALTED"
    assert CLOSED == ["roll"]
    assert robot.commands[-1][1:] == ("base", None)


@pytest.mark.parametrize(
    ("attributes", "said"),
    [
        ({"calls": ()}, "add it to `calls`"),
        ({"uses": set()}, "add 'base' to its `uses`"),
        (
            {"calls": ("rol", "roll"), "run": lambda self, robot: self.call("rol")},
            "did you mean roll",
        ),
        (
            {"run": lambda self, robot: self.call("roll", tocks=3)},
            "has no input tocks; inputs: ticks",
        ),
    ],
)
def test_what_a_caller_got_wrong_says_what_to_do(attributes, said):
    failure = run(made(**attributes)).failure
    assert any(said in link.message for link in failure.chain()), failure


def test_an_input_of_the_wrong_type_fails_the_call():
    failure = run(Twice, inputs={"ticks": 1}).failure
    assert failure is None
    kind = made(run=lambda self, robot: self.call("roll", ticks="many"))
    assert [link.code for link in run(kind).failure.chain()] == [CALL_FAILED, "WRONG_TYPE"]


def test_a_missing_service_fails_the_call():
    class Needy(Roll):
        """Need something."""

        planning_scene: object = Needs()

    chain = run(Twice, skills={"roll": Needy}).failure.chain()
    assert [link.code for link in chain] == [CALL_FAILED, "SERVICE_MISSING"]


def test_the_called_skill_may_only_command_what_it_declares():
    class Grabby(Roll):
        """Command the gripper too."""

        def run(self, robot):
            robot.command("gripper", GripperCommand(0.01, 1.0))
            yield "grabbing"

    kind = made(uses={"base", "gripper"})
    failure = run(kind, skills={"roll": Grabby}).failure
    assert "roll commands 'gripper' but its `uses` declares base" in failure.cause.message


def test_work_of_the_called_skill_takes_its_time():
    class Thinking(Roll):
        """Think."""

        def run(self, robot):
            self.drawn = yield from compute(lambda: 0.5, budget=1.0)

    result = run(Twice, skills={"roll": Thinking})
    assert result.outputs["drawn"] == (0.5, 0.5)
    assert result.duration == pytest.approx(2.0, abs=0.2)


def test_a_called_skill_calls_others():
    class Outer(Skill):
        """Call the one that calls."""

        uses = {"base"}
        calls = (Twice,)

        def run(self, robot) -> Run:
            """Call it."""
            yield from self.call(Twice, ticks=1)

    result = run(Outer)
    assert result.phases == ("Twice/roll/rolling", "Twice/between", "Twice/roll/rolling")


def test_calls_must_name_skills():
    with pytest.raises(TypeError, match="expected skills by name or class"):
        made(calls="roll")
    assert made(calls={"roll", "drive", "aim"}).calls == ("aim", "drive", "roll")


def test_in_a_tree_services_start_and_the_chain_names_the_called_skill(run_tree):
    tree = "momantu_bt: 1\ntrees: {Main: [{twice: {ticks: 0}}]}\n"
    report = run_tree(tree, skills={"twice": Twice, "roll": Roll})
    assert [link.code for link in report.failure.chain()][-2:] == [CALL_FAILED, "BLOCKED"]
    again = run_tree(tree.replace("0}", "2}"), skills={"twice": Twice, "roll": Roll})
    assert again.status == "SUCCESS"
    assert (
        again.fingerprint
        == run_tree(tree.replace("0}", "2}"), skills={"twice": Twice, "roll": Roll}).fingerprint
    )


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        (made(calls=("rol",)), "twice calls 'rol', which is not installed; did you mean roll?"),
        (made(uses=set()), "twice calls roll, which commands 'base': add 'base' to its `uses`"),
    ],
)
def test_a_call_that_cannot_be_is_found_before_the_run(run_tree, kind, said):
    with pytest.raises(TreeError) as caught:
        run_tree("momantu_bt: 1\ntrees: {Main: [twice]}\n", skills={"twice": kind, "roll": Roll})
    assert said in str(caught.value)
    assert "broken-plugin" in str(caught.value)


@pytest.mark.parametrize(
    ("kind", "said"),
    [(made(calls=("rol",)), "did you mean roll"), (made(uses=set()), "add 'base'")],
)
def test_python_that_skips_the_check_is_stopped_too(kind, said):
    registry = Registry({"twice": kind, "roll": Roll})
    description = ScriptedRobot().description
    with pytest.raises(CallError, match=said):
        check_calls({"twice": kind}, registry, description)


def test_a_replay_ticks_the_tree_of_a_recorded_call_again(run_yaml, tmp_path):
    class Quiet(Twice):
        """Roll twice, and say and draw something."""

        def run(self, robot):
            """Roll."""
            self.log("now")
            yield from super().run(robot)

    run_yaml("trees: {Main: [quiet]}", Quiet, Roll, record=tmp_path / "r")
    recording = read_record(tmp_path / "r")
    registry = Registry({"quiet": Quiet, "roll": Roll})
    result = recheck(recording, registry)
    assert result.difference is None
    phases = [step.phase for tick in recording.ticks for step in tick.steps]
    assert "roll/rolling" in phases
