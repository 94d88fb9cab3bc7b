"""From what is asked of a run to a checked tree with all that its run needs to know."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from momantu_bt.robot import RobotDescription
from momantu_bt.running.options import RunOptions
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution, load_substitution
from momantu_bt.world import Site, World


@dataclass(frozen=True, slots=True)
class Prepared:
    """A tree that can be run. document: without errors. registry: what it can name.

    substitution: what nodes do instead of themselves.
    """

    document: Document
    options: RunOptions
    registry: Registry
    substitution: Substitution


def prepare(tree: str, options: RunOptions, registry: Registry | None = None) -> Prepared:
    """Read and check a tree for a run. registry: what trees can name; what is installed by default.

    Raises:
        TreeNotFound: there is no such tree, or no such file of rules.
        TreeError: the tree or the rules have errors; all of them are in it.
    """
    having = registry if registry is not None else Registry.installed()
    world = options.world_name
    if options.world is not None and not isinstance(options.world, str):
        having = with_world(having, options.world)
    document = load(tree, having, world=world, robot=options.robot, values=options.values).document
    substitution = Substitution()
    if options.substitute is not None:
        substitution = load_substitution(options.substitute, document, having, world)
    return Prepared(document, options, having, substitution)


def with_world(registry: Registry, world: World) -> Registry:
    """The same registry, and in it an open world under its own name."""
    description = world.robot.description
    return replace(
        registry,
        worlds=ChainMap({world.name: _OpenWorld(world)}, _mutable(registry.worlds)),
        robots=ChainMap({description.name: lambda: description}, _mutable(registry.robots)),
    )


def _mutable(mapping: Mapping[str, Any]) -> Any:
    """ChainMap asks for mutable mappings, though it writes to the first one only."""
    return mapping


class _OpenWorld:
    """A world entry whose world is open already."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.name = world.name
        self.default_robot = world.robot.description.name

    def site(self) -> Site:
        """The episode's site."""
        return self._world.site

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """The world itself."""
        return self._world
