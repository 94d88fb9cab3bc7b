"""The audit: what skills claim at their ends, against a world that knows better."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from momantu_bt.claim import BaseAt, Claim, GripperOpen, Holding, Sentence
from momantu_bt.engine.context import Remarked
from momantu_bt.engine.executor import Executor
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Run, Skill
from momantu_bt.testing import ScriptedWorld


class Say(Skill):
    """Ends as it is told, and claims what it is told."""

    what: str = In("hold", doc="hold, open, both, nothing, crash or move")
    fails: bool = In(False, doc="whether it fails")
    failures = {"NO": "it does not hold"}
    uses = {"base"}

    def run(self, robot: Robot) -> Run:
        yield "thinking"
        if self.fails:
            raise Failure("NO", "no")

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        if self.what == "crash":
            raise ZeroDivisionError("by zero")
        if self.what == "move":
            robot.command("base", BaseVelocity(1.0, 0.0))
        hold, opened = Holding(True), GripperOpen(0.05)
        claims: dict[str, Claim] = {
            "hold": hold,
            "open": opened,
            "both": (hold, opened),
            "unknown": (hold, BaseAt(Pose2D(0.0, 0.0), 1.0, 1.0)),
        }
        return claims.get(self.what)


class Knowing(ScriptedWorld):
    """Holding is `held`, the gripper is open, and of the base it cannot tell."""

    def __init__(self, held: bool) -> None:
        super().__init__()
        self.held, self.asked = held, list[tuple[Sentence, Transform]]()

    def judge(self, sentence: Sentence, odom_from_base: Transform) -> bool | None:
        self.asked.append((sentence, odom_from_base))
        if isinstance(sentence, Holding):
            return sentence.something is self.held
        return True if isinstance(sentence, GripperOpen) else None


Audited = Callable[..., Any]


@pytest.fixture
def audited(run_yaml: Any) -> Audited:
    """`audited(world, "what", fails=…)`: the count of one `say`."""

    def start(world: ScriptedWorld, what: str, *, fails: bool = False, **options: Any) -> Any:
        text = f"trees: {{Main: {{say: {{what: {what}, fails: {str(fails).lower()}}}}}}}"
        report = run_yaml(text, Say, world=world, audit=True, **options)
        assert report.error is None, report.error
        return report.claims["say"]

    return start


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("fails", [True, False])
@pytest.mark.parametrize("what", ["hold", "both"])
def test_a_denied_success_and_a_false_alarm_are_lies(
    audited: Audited, what: str, fails: bool, held: bool
) -> None:
    count = audited(Knowing(held), what, fails=fails)
    assert (count.runs, count.successes, count.failures) == (1, int(not fails), int(fails))
    assert (count.judged_successes, count.judged_failures) == (int(not fails), int(fails))
    assert count.false_successes == int(not fails and not held)
    assert count.false_failures == int(fails and held)
    assert len(count.lies) == count.false_successes + count.false_failures


def test_a_lie_is_told_with_time_place_code_and_words(audited: Audited) -> None:
    (lie,) = audited(Knowing(True), "hold", fails=True).lies
    assert (lie.time, lie.code) == (0.1, "NO")
    assert lie.place.endswith("tree.yaml:3")
    assert "Holding(something=True)" in lie.claim


@pytest.mark.parametrize("what", ["nothing", "unknown"])
def test_what_nobody_claims_or_can_tell_is_not_judged(audited: Audited, what: str) -> None:
    count = audited(Knowing(True), what)
    assert (count.successes, count.judged_successes, count.false_successes) == (1, 0, 0)


def test_one_false_sentence_outweighs_one_that_nobody_can_tell(audited: Audited) -> None:
    assert audited(Knowing(False), "unknown").false_successes == 1


@pytest.mark.parametrize(("what", "error"), [("crash", "by zero"), ("move", "'base'")])
def test_a_claim_that_breaks_or_moves_the_robot_is_no_claim(
    audited: Audited, what: str, error: str
) -> None:
    world = Knowing(False)
    said: list[str] = []

    def listen(run: Executor) -> tuple[()]:
        run.context.events.subscribe(Remarked, lambda event: said.append(event.text))
        return ()

    count = audited(world, what, watch=listen)
    assert (count.successes, count.judged_successes) == (1, 0)
    assert error in said[0]
    assert not [goal for _, _, goal in world.robot.commands if goal is not None]


def test_the_judge_hears_odometry_as_skills_see_it(audited: Audited) -> None:
    world = Knowing(True)
    world.robot.base = Pose2D(1.0, 2.0, 0.5)
    audited(world, "both")
    assert [sentence for sentence, _ in world.asked] == [Holding(True), GripperOpen(0.05)]
    for _, odom_from_base in world.asked:
        assert Pose2D.from_transform(odom_from_base).distance_to(Pose2D(1.0, 2.0)) < 1e-9


def test_a_world_that_is_no_judge_leaves_all_unjudged(audited: Audited) -> None:
    count = audited(ScriptedWorld(), "hold")
    assert (count.runs, count.judged_successes, count.lies) == (1, 0, ())


def test_every_end_is_counted_and_the_run_is_the_same_without_an_audit(run_yaml: Any) -> None:
    text = "trees: {Main: [{say: hold}, {say: open}, {say: {what: both, fails: true}}]}"
    plain = run_yaml(text, Say, world=Knowing(False))
    judged = run_yaml(text, Say, world=Knowing(False), audit=True)
    assert plain.claims is None
    assert plain.as_dict()["claims"] is None
    assert plain.fingerprint == judged.fingerprint
    assert plain.ticks == judged.ticks
    count = judged.claims["say"]
    assert (count.runs, count.successes, count.failures) == (3, 2, 1)
    assert (count.false_successes, count.false_failures) == (1, 0)
    told = judged.as_dict()["claims"]["say"]
    assert told["runs"] == 3
    assert told["lies"][0]["code"] is None
