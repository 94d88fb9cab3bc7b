"""The specification and the result of one episode, as plain data to send between machines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import PurePath
from typing import Any, TypeAlias

Row: TypeAlias = dict[str, Any]
"""One finished episode, a line of `results.jsonl`; see `docs/bench.md` for its fields."""

REPORT, HUNG, KILLED, CRASHED = "report", "hung", "killed", "crashed"
"""How an episode's process ended: it left its row; a watchdog ended it (the outer one by a signal,
the run's own with exit code 1); another signal ended it; it exited without a row."""
IMPOSSIBLE = "impossible"
"""Its fault cannot happen in this tree, robot or world."""
REFUSED = "refused"
"""It could not begin, for a reason that has nothing to do with what was asked for."""


@dataclass(frozen=True, slots=True)
class EpisodeSpec:
    """The inputs of one episode, and where its record goes.

    key: names the episode on every machine. tree: path of its file. world, robot: as requested.
    values: keys of the root's board, raw as in a file. max_time: simulated seconds. referee:
    False takes it out, and what the tree says counts. goal: as given, None for the tree's.
    fault: as written, None without one. record: a folder to make; None: no record. limit: seconds
    of wall time after which the watchdog ends the process from outside. map, names: what the robot
    is told in the place of the world's, as in `RunOptions`. made_of: all else that
    decides the outcome, by name (versions, digests of files and code).
    """

    key: str
    tree: str
    seed: int
    world: str | None = None
    robot: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    max_time: float = 600.0
    referee: bool = True
    goal: Any = None
    fault: str | None = None
    record: str | None = None
    limit: float = 900.0
    map: str | None = None
    names: str | None = None
    made_of: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """For people: `seed 12`, or `seed 12 camera.dead`."""
        return f"seed {self.seed}" + (f" {self.fault}" if self.fault else "")

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return asdict(self)

    def row(self) -> Row:
        """The fields of a row that are known before its episode starts."""
        return {
            "key": self.key,
            "tree": PurePath(self.tree).name,
            "seed": self.seed,
            "fault": self.fault,
            "made_of": dict(self.made_of),
            "status": None,
            "success": None,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> EpisodeSpec:
        """The spec that `as_dict` gave; TypeError for another version's."""
        known = {each.name for each in fields(cls)}
        if unknown := set(data) - known:
            raise TypeError(f"an episode of another version: unknown {', '.join(sorted(unknown))}")
        return cls(**data)
