"""`momantu-bt skills schema`: what an editor completes in tree files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.plugins import ROBOTS, WORLDS, PluginError, load
from momantu_bt.record.files import OutputError, check_writable, write_whole
from momantu_bt.skill import Skill
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.schema import tree_schema
from momantu_bt.tree.schema_values import Names

EXIT_WRONG_INPUT = 2


def schema(
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write to this file; else print it.")
    ] = None,
    world: Annotated[
        str | None, typer.Option(help="Complete this world's places and surfaces.")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Complete the poses of a name or file.")] = None,
) -> int:
    """Print a JSON Schema of tree files, made from the installed skills.

    With it editors complete nodes, ports, codes and modifiers; `momantu-bt check` says more.

    Examples:
      momantu-bt skills schema -o trees/schema.json
      momantu-bt skills schema --world four_rooms --robot fetch -o trees/schema.json
    """
    registry = Registry.installed()
    text = json.dumps(tree_schema(_skills(registry), _names(world, robot)), indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
        return 0
    try:
        check_writable(out)
        write_whole(out, text)
    except OutputError as error:
        typer.echo(f"momantu-bt: {error}", err=True)
        return EXIT_WRONG_INPUT
    typer.echo(f"schema: {out}; begin a tree with `# yaml-language-server: $schema={out}`")
    return 0


def _skills(registry: Registry) -> dict[str, type[Skill]]:
    """All that can be loaded; says of the others why not."""
    found: dict[str, type[Skill]] = {}
    for name in registry.skills:
        try:
            found[name] = registry.skills[name]
        except PluginError as error:
            typer.echo(f"momantu-bt: left out: {error}", err=True)
    return found


def _names(world: str | None, robot: str | None) -> Names:
    """What a world and a robot can name; PluginError when there is none of that name."""
    names: dict[str, tuple[str, ...]] = {}
    if world is not None:
        site = load(WORLDS, world).site()
        names |= {"place": tuple(site.known_places()), "surface": tuple(site.surfaces)}
    if robot is not None:
        names["named_pose"] = tuple(load(ROBOTS, robot)().named_poses)
    return names
