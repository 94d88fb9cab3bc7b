"""`momantu-bt robots check`: report what makes a robot unusable, or is worth a look."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.findings import findings_json, findings_text
from momantu_bt.lazy import lazily
from momantu_bt.robots.plugins import load_robot
from momantu_skills.robot_setup.urdf.skeleton import SetupError

with lazily():
    from momantu_skills.robot_setup.check import robot as robot_check


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
    description = load_robot(robot)
    try:
        findings = robot_check.check_robot(description)
    except SetupError as error:
        raise InputError(f"{description.source or description.urdf}: {error}") from None
    if as_json:
        typer.echo(json.dumps(findings_json(description.name, findings), indent=2))
    else:
        typer.echo(findings_text(description.name, findings))
    return ExitCode.FAILURE if findings else ExitCode.SUCCESS
