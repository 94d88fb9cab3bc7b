"""`momantu-bt worlds`: the installed worlds, and the names that trees can use in each."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.cli.shared.listing import listing
from momantu_bt.errors import PLUGIN_ERRORS, MomantuError, words_of
from momantu_bt.importing import output_aside
from momantu_bt.messages import plain
from momantu_bt.plugins import PluginError
from momantu_bt.world import AboutWorld, Site, WorldEntry
from momantu_bt.world_plugins import WORLDS

worlds = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@worlds.callback(help="List the installed worlds. `momantu-bt worlds show NAME` shows one.")
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


@worlds.command("show", help="Show a world: what a tree can name, what varies, the goal.")
def show_one(
    name: Annotated[str, typer.Argument(help="The world's name, or its file.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """Show one world."""
    entry = WORLDS.load(name)
    site = _site(name, entry)
    more = entry.about() if isinstance(entry, AboutWorld) else {}
    if as_json:
        about = {
            "name": name,
            "default_robot": entry.default_robot,
            "places": plain(site.places),
            "surfaces": plain(site.surfaces),
            "objects": plain(site.objects),
            "tags": plain(site.tags),
            "about": {section: dict(lines) for section, lines in more.items()},
        }
        typer.echo(json.dumps(about, indent=2))
        return
    typer.echo(f"{name}: {_about(entry)}")
    typer.echo("\nSurfaces")
    for surface_name, surface in site.surfaces.items():
        x, y = surface.size
        top = f"round, {x:g} m across" if surface.round else f"{x:g} x {y:g} m"
        typer.echo(f"  {surface_name}: {top}, {surface.height:g} m high")
    typer.echo("\nPlaces")
    for place_name, pose in site.places.items():
        typer.echo(f"  {place_name}: x {pose.x:g} m, y {pose.y:g} m, yaw {pose.yaw:g} rad")
    typer.echo("\nObjects that the robot is told of")
    for object_name, told in site.objects.items():
        sizes = ", ".join(f"{k} {v:g} m" for k, v in plain(told).items() if isinstance(v, float))
        typer.echo(f"  {object_name}: {told.category}{', ' if sizes else ''}{sizes}")
    if site.tags:
        typer.echo("\nTags that the robot is told of")
    for tag_name, bundle in site.tags.items():
        ids = ", ".join(map(str, bundle.ids[:8])) + (", …" if len(bundle.ids) > 8 else "")
        where = "" if bundle.map_from_bundle is None else ", its place too"
        typer.echo(f"  {tag_name}: {bundle.family} {ids}{where}")
    for section, lines in more.items():
        typer.echo(f"\n{section}")
        for what, words in lines.items():
            typer.echo(f"  {what}: {words}")


def _site(name: str, entry: WorldEntry) -> Site:
    try:
        with output_aside():
            return entry.site()
    except MomantuError:
        raise
    except PLUGIN_ERRORS as error:  # a plug-in's code, which may raise anything
        message = f"the world {name!r} cannot be read: {words_of(error)}"
        raise PluginError(message) from error


def _about(entry: WorldEntry) -> str:
    site = entry.site()
    return f"{len(site.surfaces)} surfaces, {len(site.places)} places, robot {entry.default_robot}"
