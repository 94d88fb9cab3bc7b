"""All checks of a robot, in order."""

from __future__ import annotations

from collections.abc import Iterable

from momantu_bt.descriptions.reading import Reading, read_text
from momantu_bt.findings import Finding, FindingAtKeys, worst_first
from momantu_bt.formats.places import NOWHERE
from momantu_bt.formats.urdf import read_urdf
from momantu_bt.robot import RobotDescription
from momantu_bt.robots import RobotFileError
from momantu_bt.robots.reader import read_robot_file
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.robot_setup.check.abilities import check_abilities
from momantu_skills.robot_setup.check.body import (
    check_footprint,
    check_hulls,
    check_limits,
    check_looks,
    check_poses,
)
from momantu_skills.robot_setup.check.hand import UNFIT, check_hand, check_reach, check_stand_off
from momantu_skills.robot_setup.check.pads import check_pads
from momantu_skills.robot_setup.check.sensors import check_sensors
from momantu_skills.robot_setup.find.base import find_stand
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.skeleton import read_skeleton


def check_robot(description: RobotDescription) -> list[Finding]:
    """All findings about a robot, each at its line of the robot file.

    Raises:
        SetupError: the URDF is not a mechanism, or has a collision shape without volume.
    """
    skeleton = read_skeleton(read_urdf(description.urdf))
    body = Body(skeleton, description)
    stand = find_stand(body)
    findings = [
        *check_footprint(description, body, stand),
        *check_limits(description, body),
        *check_hulls(description, body),
        *check_looks(description),
        *check_sensors(description, body),
        *check_stand_off(description),
        *check_abilities(description, stand, virtual=_has_virtual(description)),
    ]
    model = ArmModel(description) if description.has_arm else None
    if model is not None:
        findings += check_poses(description, model)
    if description.end_effector is not None:
        findings += check_hand(description, body)
    if model is not None and description.end_effector is not None:
        if all(finding.code != UNFIT for finding in findings):  # else the fingers are elsewhere
            findings += check_pads(model)
        findings += check_reach(description, stand)
    return _located(description, findings)


def _has_virtual(description: RobotDescription) -> bool:
    """Whether the robot's own URDF has the joints that move its base."""
    drive = None if description.source is None else read_robot_file(description.source).base.drive
    return drive is not None and drive.joints is not None


def _located(description: RobotDescription, findings: Iterable[FindingAtKeys]) -> list[Finding]:
    """The findings, each at its line of the robot file, the worst first."""
    source = description.source
    if source is None:
        return worst_first(finding.at(NOWHERE) for finding in findings)
    reading = Reading(source, read_text(source, RobotFileError), RobotFileError)
    return worst_first(finding.at(reading.at(finding.keys, key=True)) for finding in findings)
