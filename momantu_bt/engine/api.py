"""`momantu_bt.run`: a tree, from its file to its report, in one call."""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from momantu_bt.engine.launch import Options, Watch, launch
from momantu_bt.engine.person import Scripted
from momantu_bt.faults.spec import parse_fault
from momantu_bt.record.report import Report
from momantu_bt.robot import RobotDescription
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution, load_substitution
from momantu_bt.world import Site, World


def run(
    tree: str | Path,
    *,
    world: str | World | None = None,
    robot: str | None = None,
    seed: int = 0,
    values: Mapping[str, Any] | None = None,
    max_time: float = 600.0,
    realtime: bool = False,
    referee: bool = True,
    audit: bool = False,
    report: Path | None = None,
    registry: Registry | None = None,
    watch: Watch | None = None,
    answers: Iterable[str | bool] = (),
    substitute: str | Path | None = None,
    faults: Iterable[str] = (),
    patience: float = math.inf,
    record: Path | None = None,
) -> Report:
    """Run a tree file, or a bundled tree by name.

    world: a world's name, `"none"`, an open world (which stays open), or None for the tree's
    own. values: keys of the root's board, as `--set` gives them. max_time: simulated seconds.
    audit: judge what skills claim by ground truth, and tell it in the report.
    report: where to write it as JSON. registry: what trees can name; everything installed
    unless given. watch: makes observers of the run. answers: what `ask` and `confirm` are told,
    in turn; afterwards nobody answers. substitute: a file of rules that say what nodes do
    instead of themselves. faults: what is broken on purpose, such as `camera.dead@navigate`.
    patience: seconds of wall time that a skill's step may take; what hangs longer in native code
    ends the process, which is yours: so there is no limit unless one is given. record: a
    new folder for the run's record.

    Raises:
        TreeNotFound: there is no such tree.
        TreeError: the tree has errors; all of them are in it.
        LaunchError: the run cannot begin as asked.
        WorldError: the world could not start.
        FaultError: a fault that is none, or that this run cannot have.
        OutputError: the record's folder cannot be written, or holds a record already.
    """
    wanted = tuple(parse_fault(text) for text in faults)
    having = registry if registry is not None else Registry.installed()
    named = world if world is None or isinstance(world, str) else world.name
    if world is not None and not isinstance(world, str):
        having = with_world(having, world)
    checked = load(str(tree), having, world=named, robot=robot, values=values)
    replacing = Substitution()
    if substitute is not None:
        replacing = load_substitution(Path(substitute), checked.document, having, named)
    options = Options(
        world=named,
        robot=robot,
        seed=seed,
        max_time=max_time,
        realtime=realtime,
        referee=referee,
        audit=audit,
        keep_world=named is not world,
        person=Scripted(answers),
        substitution=replacing,
        faults=wanted,
        patience=patience,
        record=record,
    )
    result = launch(checked.document, options, having, watch)
    if report is not None:
        result.write(report)
    return result


def with_world(registry: Registry, world: World) -> Registry:
    """The same registry, and in it an open world under its own name."""
    description = world.robot.description
    return Registry(
        skills=registry.skills,
        worlds=ChainMap({world.name: _OpenWorld(world)}, _mutable(registry.worlds)),
        robots=ChainMap({description.name: lambda: description}, _mutable(registry.robots)),
        services=registry.services,
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
