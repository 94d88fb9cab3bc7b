"""What a robot lacks for a skill: actuators and sensors, also those of the services it needs."""

from __future__ import annotations

from typing import Any

import pytest

from momantu_bt.formats.problems import Severity
from momantu_bt.lacking import lacking, lacks_text
from momantu_bt.robot import CAMERA_CARRIER, RobotDescription
from momantu_bt.service import Service
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.testing import armless_robot, small_robot
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.registry import Registry


class Grabs(Skill):
    """Take something."""

    uses = {"arm", "gripper"}

    def run(self, robot: Any) -> Run:
        """Do nothing."""
        yield ""


class Looks(Skill):
    """Look."""

    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    where: Any = Needs()

    def run(self, robot: Any) -> Run:
        """Do nothing."""
        yield ""


class Where(Service):
    needs = ("scans",)


class Scans(Service):
    senses = ("laser",)


SERVICES = {"where": Where, "scans": Scans}


def without(description: RobotDescription, *kinds: str) -> RobotDescription:
    left = {n: s for n, s in description.sensors.items() if s.kind not in kinds}
    return description.model_copy(update={"sensors": left})


@pytest.mark.parametrize(
    ("kind", "robot", "lacks"),
    [
        (Grabs, small_robot(), []),
        (Grabs, armless_robot(), ["the actuator 'arm'", "the actuator 'gripper'"]),
        (Looks, armless_robot(), []),
        (Looks, without(small_robot(), "camera"), ["a camera"]),
        (Looks, without(small_robot(), "laser"), ["a laser"]),
        (Looks, without(small_robot(), "laser", "camera"), ["a camera", "a laser"]),
    ],
)
def test_what_is_lacking(kind: type[Skill], robot: RobotDescription, lacks: list[str]) -> None:
    assert list(lacking(kind, SERVICES, robot)) == lacks


def test_the_sentence_names_skill_lack_and_what_there_is() -> None:
    said = lacks_text("grab", lacking(Grabs, {}, armless_robot()), armless_robot())
    assert said.startswith(
        "grab needs the actuator 'arm' and the actuator 'gripper', and the robot"
    )
    assert "actuators: base, head" in said


def test_a_tree_is_refused_at_the_first_node_of_each_such_skill() -> None:
    text = "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n    - looks:\n    - grabs:\n    - grabs:\n"
    document, reading = read(text, "tree.yaml")
    registry = Registry(
        skills={"grabs": Grabs, "looks": Looks},
        robots={"cart": armless_robot},
        services=SERVICES,
    )
    found = check(document, registry, robot="cart", reading=reading).problems
    lacks = [(p.code, p.place.line, p.severity) for p in found if p.code == "robot-lacks"]
    assert lacks == [("robot-lacks", 6, Severity.ERROR)]


def test_a_robot_without_a_hand_says_so() -> None:
    with pytest.raises(LookupError, match="armless has no end effector"):
        _ = armless_robot().hand
    with pytest.raises(LookupError, match="no arm"):
        _ = armless_robot().working.reached
    assert not armless_robot().has_arm
    assert small_robot().has_arm
