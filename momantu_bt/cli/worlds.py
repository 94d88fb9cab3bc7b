"""`momantu-bt worlds`: what is installed, and what a tree can name in each world."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.cli.listing import listing
from momantu_bt.messages import plain
from momantu_bt.plugins import WORLDS, load
from momantu_bt.world import WorldEntry

worlds = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@worlds.callback(help="List the installed worlds. `momantu-bt worlds show four_rooms` shows one.")
def every(
    context: typer.Context,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """List the installed worlds, unless one of them is to be shown."""
    if context.invoked_subcommand is None:
        listing(WORLDS, _about, as_json)


@worlds.command("list", help="List the installed worlds.")
def list_all(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """List the installed worlds."""
    listing(WORLDS, _about, as_json)


@worlds.command("show", help="Show a world's places, surfaces and objects.")
def show_one(
    name: Annotated[str, typer.Argument(help="The world's name, as in trees.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """Show one world."""
    entry: WorldEntry = load(WORLDS, name)
    site = entry.site()
    if as_json:
        about = {
            "name": name,
            "default_robot": entry.default_robot,
            "places": plain(site.places),
            "surfaces": plain(site.surfaces),
            "objects": plain(site.objects),
        }
        typer.echo(json.dumps(about, indent=2))
        return
    typer.echo(f"{name}: {_about(entry)}")
    typer.echo("\nSurfaces")
    for surface_name, surface in site.surfaces.items():
        x, y = surface.size
        typer.echo(f"  {surface_name}: {x:g} x {y:g} m, {surface.height:g} m high")
    typer.echo("\nPlaces")
    for place_name, pose in site.places.items():
        typer.echo(f"  {place_name}: x {pose.x:g} m, y {pose.y:g} m, yaw {pose.yaw:g} rad")
    typer.echo(f"\nObjects   {', '.join(site.objects) or 'none'}")


def _about(entry: WorldEntry) -> str:
    site = entry.site()
    return f"{len(site.surfaces)} surfaces, {len(site.places)} places, robot {entry.default_robot}"
