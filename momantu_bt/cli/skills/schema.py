"""`momantu-bt skills schema`: a JSON Schema of tree files, for editors."""

from __future__ import annotations

from typing import Annotated

import typer

from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.schema_file import Out, put_schema
from momantu_bt.errors import ExitCode
from momantu_bt.plugins import PluginError
from momantu_bt.robots.plugins import load_robot
from momantu_bt.skill import Skill
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.show.schema import tree_schema
from momantu_bt.tree.show.schema_values import Names
from momantu_bt.world_plugins import WORLDS


def schema(
    out: Out = None,
    world: Annotated[
        str | None, typer.Option(help="Complete this world's places and surfaces.")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Complete the poses of a name or file.")] = None,
) -> ExitCode:
    """Print a JSON Schema of tree files, made from the installed skills.

    With it editors complete nodes, ports, codes and modifiers; `momantu-bt check` says more.

    Examples:
      momantu-bt skills schema -o trees/schema.json
      momantu-bt skills schema --world my_flat.yaml --robot my_robot/ -o trees/schema.json
    """
    registry = Registry.installed()
    return put_schema(tree_schema(_skills(registry), _names(world, robot)), out, "a tree")


def _skills(registry: Registry) -> dict[str, type[Skill]]:
    """All that can be loaded; says of the others why not."""
    found: dict[str, type[Skill]] = {}
    for name in registry.skills:
        try:
            found[name] = registry.skills[name]
        except PluginError as error:
            notice(f"left out: {error}")
    return found


def _names(world: str | None, robot: str | None) -> Names:
    """The names of a world and a robot; PluginError when there is no such world or robot."""
    names: dict[str, tuple[str, ...]] = {}
    if world is not None:
        site = WORLDS.load(world).site()
        names |= {"place": tuple(site.known_places()), "surface": tuple(site.surfaces)}
        names["tag"] = tuple(site.tags)
    if robot is not None:
        names["named_pose"] = tuple(load_robot(robot).named_poses)
    return names
