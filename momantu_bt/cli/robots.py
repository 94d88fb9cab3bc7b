"""`momantu-bt robots`: what is installed, and what a tree can name of each robot."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Annotated

import typer

from momantu_bt.cli.listing import listing
from momantu_bt.plugins import ROBOTS, load
from momantu_bt.robot import RobotDescription

robots = typer.Typer(rich_markup_mode=None, invoke_without_command=True)

Description = Callable[[], RobotDescription]


@robots.callback(help="List the installed robots. `momantu-bt robots show fetch` shows one.")
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


@robots.command("show", help="Show a robot's actuators, sensors and named poses.")
def show_one(
    name: Annotated[str, typer.Argument(help="The robot's name, or its file.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """Show one robot."""
    describe: Description = load(ROBOTS, name)
    description = describe()
    if as_json:
        about = {
            "name": name,
            "actuators": {n: a.kind.value for n, a in description.actuators.items()},
            "sensors": {n: s.kind for n, s in description.sensors.items()},
            "groups": {n: list(g.joints) for n, g in description.groups.items()},
            "named_poses": description.named_poses,
        }
        typer.echo(json.dumps(about, indent=2))
        return
    typer.echo(f"{name}: {_about(describe)}")
    typer.echo("\nActuators")
    for actuator_name, actuator in description.actuators.items():
        typer.echo(f"  {actuator_name}: {', '.join(actuator.joints) or actuator.kind.value}")
    typer.echo("\nSensors")
    for sensor_name, sensor in description.sensors.items():
        typer.echo(f"  {sensor_name}: {sensor.kind}, in {sensor.frame}")
    typer.echo(f"\nNamed poses   {', '.join(description.named_poses)}")


def _about(describe: Description) -> str:
    description = describe()
    joints = len(description.joint_limits)
    return f"{joints} joints, {', '.join(description.actuators)}; {', '.join(description.sensors)}"
