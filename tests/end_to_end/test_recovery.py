"""Whatever a skill of the main tree fails with once, the tree mends; what lasts ends the run."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from momantu_bt import run
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, SupportPlane
from momantu_bt.robot import Robot
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry

TREE = Path(__file__).resolve().parents[2] / "trees" / "bring_object.yaml"
INSTALLED = Registry.installed()
USED = (
    "navigate", "relocalize", "check", "detect_object", "find_apriltag", "detect_plane", "pick",
    "place", "reset_pose", "release", "find_surface", "examine_hand",
)  # fmt: skip
NEVER_HERE = {
    ("navigate", "BAD_GOAL"), ("reset_pose", "UNKNOWN_POSE"), ("check", "BAD_QUESTION"),
    ("check", "HOLDING"), ("check", "NOT_NEAR"), ("check", "NOT_OPEN"),
}  # fmt: skip
"""Failures that only a wrong tree provokes, or questions that this tree never asks."""
FINAL = {("place", "TOPPLED"), ("place", "LOST")}
"""The object lies somewhere: no skill picks up what has fallen."""
LETS_GO = {"place", "release"}
HANDLERS_OWN = {"relocalize", "release", "find_surface", "examine_hand"}
"""Skills that only handlers start."""

POSE = Pose(Transform((1.0, 0.0, 0.8)), "odom", 0.0)
OUTPUTS: dict[str, Any] = {
    "found": DetectedObject("can", POSE, (0.07, 0.07, 0.13), "cylinder", 1.0, 0.7),
    "tag_pose": POSE,
    "tag_sigma": 0.001,
    "tag_covariance": (0.0,) * 36,
    "plane": SupportPlane(POSE, ((-1, -1), (1, -1), (1, 1), (-1, 1))),
    "spots": (POSE,),
    "holding": True,
}


ANY_SKILL = ("SENSOR_DEAD", "SKILL_ERROR", "WRONG_TYPE", "HUNG")
"""Codes of the engine that befall any skill."""


def possible(name: str) -> Iterator[str]:
    for code in (*INSTALLED.skills[name].failures, *ANY_SKILL):
        if (name, code) not in NEVER_HERE:
            yield code


ONCE = [(name, code) for name in USED if name not in HANDLERS_OWN for code in possible(name)]


class Script:
    """What each start of a skill does: succeed, or fail with the next code scripted for it.

    holding: whether the hand has the object, for the questions that ask for it; None: it cannot be
    told. really: what examining the hand finds out; None: nothing new. cut_off: a pick that fails
    has the object all the same.
    """

    def __init__(self) -> None:
        self.failures: dict[str, list[str]] = {}
        self.always: dict[str, str] = {}
        self.starts: list[str] = []
        self.holding: bool | None = False
        self.really: bool | None = None
        self.cut_off = False

    def skills(self) -> dict[str, type[Skill]]:
        return {name: self._stand_in(name) for name in USED}

    def _stand_in(self, name: str) -> type[Skill]:
        real, script = INSTALLED.skills[name], self

        def work(self: Skill, robot: Robot) -> Run:
            script.starts.append(name)
            yield "working"
            if name == "check" and self.what in ("holding", "not_holding"):
                if script.holding is None:
                    raise Failure("HOLDING_UNKNOWN", "it cannot be told")
                if script.holding is not (self.what == "holding"):
                    code = "HOLDING" if script.holding else "NOT_HOLDING"
                    raise Failure(code, "the hand says otherwise")
            if name == "examine_hand" and script.really is not None:
                script.holding = script.really
            code = next(iter(script.failures.get(name, [])), script.always.get(name))
            if code is not None:
                if script.failures.get(name):
                    script.failures[name].pop(0)
                script.holding &= code != "NOT_HOLDING"
                script.holding |= name == "pick" and script.cut_off
                raise Failure(code, "as the test wants it")
            if script.holding is not None:
                script.holding = (script.holding or name == "pick") and name not in LETS_GO
            for port in real.ports.values():
                if port.direction == "out":
                    setattr(self, port.name, OUTPUTS[port.name])

        return type(real.__name__, (real,), {"run": work, "needs": (), "__doc__": real.__doc__})


def bring(script: Script) -> Any:
    registry = Registry(script.skills(), {}, {}, dict.fromkeys(INSTALLED.services))
    return run(TREE, world=ScriptedWorld(), registry=registry, max_time=300.0)


def test_without_failures_each_step_runs_in_order() -> None:
    script = Script()
    assert bring(script).status == "SUCCESS"
    assert script.starts == [
        "reset_pose", "check", "check", "navigate", "check", "detect_object", "navigate",
        "reset_pose", "check", "check", "detect_object", "pick", "reset_pose", "check",
        "check", "navigate", "check", "check", "find_apriltag", "navigate", "find_apriltag",
        "detect_plane", "place", "reset_pose",
    ]  # fmt: skip


@pytest.mark.parametrize(("name", "code"), [pair for pair in ONCE if pair not in FINAL])
def test_one_failure_is_mended(name: str, code: str) -> None:
    script = Script()
    script.failures[name] = [code]
    report = bring(script)
    assert report.status == "SUCCESS", report.failure
    assert script.failures[name] == []


@pytest.mark.parametrize("code", ["ARM_STUCK", "SLIPPED", "SENSOR_DEAD", "SKILL_ERROR", "HUNG"])
def test_what_a_grasp_that_was_cut_off_holds_is_not_let_fall(code: str) -> None:
    script = Script()
    script.cut_off = True
    script.failures["pick"] = [code]
    assert bring(script).status == "SUCCESS"
    assert script.starts.count("pick") == 1
    assert "release" not in script.starts


def test_what_may_be_in_the_hand_is_neither_looked_for_nor_let_fall() -> None:
    script = Script()
    script.holding = None
    report = bring(script)
    assert report.failure is not None
    assert "HOLDING_UNKNOWN" in [link.code for link in report.failure.chain()]
    assert not {"detect_object", "pick", "release", "place"} & set(script.starts)


@pytest.mark.parametrize("really", [True, False])
def test_what_may_be_in_the_hand_is_found_out(really: bool) -> None:
    script = Script()
    script.holding, script.really = None, really
    report = bring(script)
    assert report.status == "SUCCESS", report.failure
    assert script.starts.count("examine_hand") == 1
    assert script.starts.count("pick") == (0 if really else 1)


def test_what_is_held_after_a_failure_is_not_looked_for_on_the_table() -> None:
    script = Script()

    class Stuck(list[str]):
        """Fails the carrying pose three times, once the can is in the hand."""

        left = 3

        def __iter__(self):
            take = script.holding and self.left > 0
            self.left -= take
            return iter(["ARM_STUCK"] if take else [])

        def __bool__(self) -> bool:
            return False

    script.failures["reset_pose"] = Stuck()
    assert bring(script).status == "SUCCESS"
    assert script.starts.count("detect_object") == 2, "the two looks before the grasp"
    assert script.starts.count("pick") == 1


@pytest.mark.parametrize(("name", "code"), ONCE)
def test_a_failure_that_lasts_ends_the_run_with_its_chain(name: str, code: str) -> None:
    script = Script()
    script.always[name] = code
    report = bring(script)
    assert report.status == "FAILURE"
    assert report.failure is not None
    assert code in [link.code for link in report.failure.chain()], str(report.failure)
    assert report.sim_time_s < 300.0


@pytest.mark.parametrize(("name", "code"), sorted(FINAL))
def test_what_fell_is_not_claimed(name: str, code: str) -> None:
    script = Script()
    script.failures[name] = [code]
    report = bring(script)
    assert report.status == "FAILURE"
    assert script.starts.count("pick") == 1
