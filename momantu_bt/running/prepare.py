"""Reads and checks a tree for a run, and collects what the run needs."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from momantu_bt.robot import RobotDescription
from momantu_bt.running.options import RunOptions
from momantu_bt.running.told import Told, read_told, with_told
from momantu_bt.tree.check.elsewhere import missing_for_a_run
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution, load_substitution, reached
from momantu_bt.world import Site, World


@dataclass(frozen=True, slots=True)
class Prepared:
    """A tree that is ready to run. document: without errors. registry: the plug-ins it can name.

    substitution: the nodes to replace, and by what. told: what the robot is told in the place of
    its site's own; None: nothing.
    """

    document: Document
    options: RunOptions
    registry: Registry
    substitution: Substitution
    told: Told | None = None


def prepare(
    tree: str | TreeText, options: RunOptions, registry: Registry | None = None
) -> Prepared:
    """Read and check a tree for a run. registry: plug-ins it can name; by default all installed.

    Raises:
        TreeNotFound: the tree or the file of rules does not exist.
        TreeError: the tree or the rules have errors; the exception lists all of them.
        InputError, MapError, SiteFileError: the map or the names to be told are wrong.
    """
    having = registry if registry is not None else Registry.installed()
    world = options.world_name
    if options.world is not None and not isinstance(options.world, str):
        having = with_world(having, options.world)
    told = read_told(options.map, options.names)
    if told is not None:
        having = with_told(having, told)
    document = load(
        tree,
        having,
        world=world,
        robot=options.robot,
        values=options.values,
        include=options.include,
        goal=options.goal,
        tolerant=options.tolerant or options.substitute is not None,
    ).document
    substitution = Substitution()
    if options.substitute is not None:
        substitution = load_substitution(options.substitute, document, having, world)
    refuse_missing(document, having, substitution)
    return Prepared(document, options, having, substitution, told)


def refuse_missing(document: Document, registry: Registry, substitution: Substitution) -> None:
    """Refuse a run that may need a node or a tree that stands elsewhere.

    Raises:
        TreeError: there is such a node; the exception says of each what to do.
    """
    reachable = (
        (node, bool(substitution.of(node)))
        for node in reached(document, substitution.results)
        if not substitution.replaces(node)
    )
    missing = missing_for_a_run(Context(document, registry, Problems()), reachable)
    if missing:
        raise TreeError(missing, document.source)


def with_world(registry: Registry, world: World) -> Registry:
    """A copy of the registry with an open world added under the world's name."""
    description = world.robot.description
    return replace(
        registry,
        worlds=ChainMap({world.name: _OpenWorld(world)}, _mutable(registry.worlds)),
        robots=ChainMap({description.name: lambda: description}, _mutable(registry.robots)),
    )


def _mutable(mapping: Mapping[str, Any]) -> Any:
    """Cast for ChainMap, which requires mutable mappings but writes only to the first one."""
    return mapping


class _OpenWorld:
    """A world entry for a world that is already open."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.name = world.name
        self.default_robot = world.robot.description.name

    def site(self) -> Site:
        """The episode's site."""
        return self._world.site

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """Return the open world."""
        return self._world
