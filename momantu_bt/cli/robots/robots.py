"""`momantu-bt robots`: the installed robots, and the names that trees can use of each."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.cli.robots.schema import schema
from momantu_bt.cli.robots.text import robot_lines
from momantu_bt.cli.shared.help import help_of
from momantu_bt.cli.shared.listing import listing
from momantu_bt.robots.plugins import ROBOTS, Describe, load_robot
from momantu_bt.robots.summary import summary

robots = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@robots.callback(help="List the installed robots. `momantu-bt robots show NAME` shows one.")
def every(
    context: typer.Context,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """List the installed robots, unless one of them is to be shown."""
    if context.invoked_subcommand is None:
        listing(ROBOTS, _about, as_json)


@robots.command("list", help="List the installed robots.")
def list_all(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """List the installed robots."""
    listing(ROBOTS, _about, as_json)


@robots.command("show", help="Show a robot: parts, joints, sensors, hand, poses.")
def show_one(
    name: Annotated[str, typer.Argument(help="The robot's name, or its file.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """Show one robot."""
    about = summary(load_robot(name))
    if as_json:
        typer.echo(json.dumps(about, indent=2))
        return
    typer.echo(about["name"])
    for line in robot_lines(about):
        typer.echo(line)


robots.command("schema", help=help_of(schema))(schema)


def _about(describe: Describe) -> str:
    description = describe()
    joints = len(description.joint_limits)
    return f"{joints} joints, {', '.join(description.actuators)}; {', '.join(description.sensors)}"
