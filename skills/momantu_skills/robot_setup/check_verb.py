"""`momantu-bt robots check`: everything that makes a robot unusable or worth a second look."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

from momantu_bt.descriptions.reading import Reading, read_text
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.findings import Finding, FindingAtKeys, findings_json, findings_text, worst_first
from momantu_bt.formats.places import NOWHERE
from momantu_bt.robots import RobotFileError

if TYPE_CHECKING:
    from momantu_bt.robot import RobotDescription


def check(
    robot: Annotated[str, typer.Argument(help="An installed robot's name, or a robot file.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> ExitCode:
    """Say what is wrong with a robot: collisions, sensors that see it, hand, reach, footprint.

    Errors make the robot useless for something; warnings are worth a look.

    Exit code 0: nothing was found; 1: something was; 2: the file cannot be read.

    Examples:
      momantu-bt robots check my_robot
      momantu-bt robots check robots/my_robot/robot.yaml
      momantu-bt robots check my_robot/ --json
    """
    from momantu_bt.robots.named import load_robot
    from momantu_skills.robot_setup.urdf.skeleton import SetupError

    description = load_robot(robot)
    try:
        findings = check_robot(description)
    except SetupError as error:
        raise InputError(f"{description.source or description.urdf}: {error}") from None
    if as_json:
        typer.echo(json.dumps(findings_json(description.name, findings), indent=2))
    else:
        typer.echo(findings_text(description.name, findings))
    return ExitCode.FAILURE if findings else ExitCode.SUCCESS


def check_robot(description: RobotDescription) -> list[Finding]:
    """Everything that is found, in order.

    Raises:
        SetupError: the URDF is no mechanism, or has a collision shape without volume.
    """
    from momantu_skills.manipulation.model.arm_model import ArmModel
    from momantu_skills.robot_setup.check.body import (
        check_footprint,
        check_hulls,
        check_limits,
        check_looks,
        check_poses,
        read_urdf,
    )
    from momantu_skills.robot_setup.check.hand import check_hand, check_reach
    from momantu_skills.robot_setup.check.sensors import check_sensors
    from momantu_skills.robot_setup.find.base import find_stand
    from momantu_skills.robot_setup.urdf.body import Body
    from momantu_skills.robot_setup.urdf.skeleton import read_skeleton

    body = Body(read_skeleton(read_urdf(description)), description)
    stand = find_stand(body)
    return _located(
        description,
        [
            *check_poses(description, ArmModel(description)),
            *check_footprint(description, body, stand),
            *check_limits(description, body),
            *check_hulls(description, body),
            *check_looks(description),
            *check_sensors(description, body),
            *check_hand(description, body),
            *check_reach(description, body, stand),
        ],
    )


def _located(description: RobotDescription, findings: Iterable[FindingAtKeys]) -> list[Finding]:
    """The findings, each at its line of the robot file, the worst first."""
    source = description.source
    if source is None:
        return worst_first(finding.at(NOWHERE) for finding in findings)
    reading = Reading(source, read_text(source, RobotFileError), RobotFileError)
    return worst_first(finding.at(reading.at(finding.keys, key=True)) for finding in findings)
