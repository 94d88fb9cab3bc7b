"""The options of a run: one value that is passed on unchanged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from momantu_bt.engine.person import Person, Scripted
from momantu_bt.engine.watchdog import PATIENCE
from momantu_bt.fault import Fault
from momantu_bt.world import World

_RECORDED = (
    *("world", "robot", "goal", "max_time", "realtime", "referee", "audit", "faults"),
    *("map", "names", "measured_start", "patience"),
)


@dataclass(frozen=True, slots=True)
class RunOptions:
    """How to run a tree.

    world: a name, a file, `"none"`, an open world (which stays open), or None for the tree's own.
    robot: a name or a file, or None for the world's default.
    goal: what the referee demands, in the place of the tree's own goal: "world", "none", a text
    such as "can on table_b beside tag", a mapping, or a list of these.
    map: the floor plan that the robot is told in the place of the world's: a folder that
    `momantu-bt map` wrote, a map_server YAML file, or "none". names: a site file, or such a folder,
    with the places and surfaces that it is told in the place of the world's. measured_start: the
    robot is told exactly where it stands at first, as by a person who puts it down to make a map;
    in a world that does not know it, what the site says.
    seed: selects the variation of the episode. values: initial keys of the root's board, as with
    `--set`. substitute: a file of rules that replace nodes. include: further tree files, or folders
    of them, that have trees which the tree runs. tolerant: nodes, trees and keys that stand
    elsewhere are warnings; a run that may reach such a node or tree is refused all the same.
    faults: the faults to inject.
    max_time: simulated time after which the run fails with TIMEOUT, s.
    realtime: do not run faster than real time.
    referee: False removes the referee; the run stays the same. audit: compare the skills' claims
    with ground truth; the run stays the same.
    patience: limit of wall time for a skill's step, s; then it fails with HUNG. After 1.5 times
    the limit the process ends. inf: no limit.
    record: a new folder for the run's record.
    person: answers `ask` and `confirm`; by default nobody answers.
    remark: called with messages for a person; they never influence the run. stage: called with
    what is being prepared, before the first tick.
    """

    world: str | World | None = None
    robot: str | None = None
    goal: Any = None
    map: str | None = None
    names: str | None = None
    measured_start: bool = False
    seed: int = 0
    values: Mapping[str, Any] = field(default_factory=dict)
    substitute: Path | None = None
    include: tuple[Path, ...] = ()
    tolerant: bool = False
    faults: tuple[Fault, ...] = ()
    max_time: float = 600.0
    realtime: bool = False
    referee: bool = True
    audit: bool = False
    patience: float = PATIENCE
    record: Path | None = None
    person: Person = field(default_factory=Scripted)
    remark: Callable[[str], None] = field(default=lambda text: None)
    stage: Callable[[str], None] = field(default=lambda text: None)

    @property
    def world_name(self) -> str | None:
        """The world's name or path, as in a tree file or on the command line."""
        world = self.world
        return world if world is None or isinstance(world, str) else world.name

    def recorded(self) -> dict[str, Any]:
        """The options that a record stores, without the seed and the texts of files."""
        chosen = {name: getattr(self, name) for name in _RECORDED}
        return {**chosen, "world": self.world_name}
