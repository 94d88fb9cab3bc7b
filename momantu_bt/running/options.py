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
    *("world", "robot", "max_time", "realtime", "referee", "audit", "faults"),
    "patience",
)


@dataclass(frozen=True, slots=True)
class RunOptions:
    """How to run a tree.

    world: a name, a file, `"none"`, an open world (which stays open), or None for the tree's own.
    robot: a name or a file, or None for the world's default.
    seed: varies the episode. values: keys of the root's board, as `--set` gives them.
    substitute: a file of rules that say what nodes do instead of themselves.
    faults: what is broken on purpose.
    max_time: simulated seconds after which the run fails with TIMEOUT.
    realtime: no faster than the simulated clock.
    referee: False takes it out, which changes nothing else. audit: judge by ground truth what
    skills claim, which changes nothing else.
    patience: seconds of wall time that a skill's step may take before it fails with HUNG; half as
    much more, and the process ends. inf: for ever.
    record: a new folder for the run's record.
    person: who answers `ask` and `confirm`; nobody unless given.
    remark: tells a person something that never influences the run.
    """

    world: str | World | None = None
    robot: str | None = None
    seed: int = 0
    values: Mapping[str, Any] = field(default_factory=dict)
    substitute: Path | None = None
    faults: tuple[Fault, ...] = ()
    max_time: float = 600.0
    realtime: bool = False
    referee: bool = True
    audit: bool = False
    patience: float = PATIENCE
    record: Path | None = None
    person: Person = field(default_factory=Scripted)
    remark: Callable[[str], None] = field(default=lambda text: None)

    @property
    def world_name(self) -> str | None:
        """The world as a tree or a command line names it."""
        world = self.world
        return world if world is None or isinstance(world, str) else world.name

    def recorded(self) -> dict[str, Any]:
        """The options that a record stores, beside the seed and the texts of files."""
        chosen = {name: getattr(self, name) for name in _RECORDED}
        return {**chosen, "world": self.world_name}
