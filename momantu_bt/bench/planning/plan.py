"""Plan a bench: which episodes are wanted, done and missing."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from momantu_bt.bench.planning.made_of import difference, key_of
from momantu_bt.bench.rows.spec import EpisodeSpec, Row
from momantu_bt.formats.files import write_whole
from momantu_bt.formats.seeds import parse_seeds, seeds_text

PLAN = "plan.json"
RECORDS = "records"


@dataclass(frozen=True, slots=True)
class Wanted:
    """Episodes of one tree: pairs of seed and fault (None: without one), and their inputs."""

    episodes: tuple[tuple[int, str | None], ...]
    made_of: Mapping[str, str]

    def key(self, episode: tuple[int, str | None]) -> str:
        """The key of one of them."""
        return key_of(self.made_of, *episode)

    def shard(self, number: int, of: int) -> Wanted:
        """Every `of`-th episode, beginning with that number, counted from 1."""
        return Wanted(self.episodes[number - 1 :: of], self.made_of)

    def present(self, rows: Mapping[str, Row]) -> list[Row]:
        """The rows of these episodes that exist, in their order."""
        keys = map(self.key, self.episodes)
        return [rows[key] for key in keys if key in rows]

    def missing(self, rows: Mapping[str, Row]) -> list[str]:
        """Those without a row, a sentence for each fault: `seeds 12, 40-47 of camera.dead`."""
        found: dict[str | None, list[int]] = {}
        for seed, fault in self.episodes:
            if self.key((seed, fault)) not in rows:
                found.setdefault(fault, []).append(seed)
        return [
            f"seeds {seeds_text(seeds)}" + (f" of {fault}" if fault else "")
            for fault, seeds in found.items()
        ]

    def others(self, rows: Iterable[Row]) -> dict[tuple[str, ...], int]:
        """The number of rows with other inputs, by the names of the differing inputs."""
        found: dict[tuple[str, ...], int] = {}
        for row in rows:
            differs = difference(self.made_of, row["made_of"])
            if differs:
                found[differs] = found.get(differs, 0) + 1
        return found

    def united(self, other: Wanted | None) -> Wanted:
        """All that either wants; another one that is made of something else does not count."""
        if other is None or dict(other.made_of) != dict(self.made_of):
            return self
        return Wanted(tuple(dict.fromkeys((*other.episodes, *self.episodes))), self.made_of)

    def write(self, folder: Path) -> None:
        """Write the plan into a folder of results, for merging and for reporting what is missing.

        Raises:
            OutputError: it cannot be written.
        """
        seeds: dict[str, list[int]] = {}
        for seed, fault in self.episodes:
            seeds.setdefault(fault or "", []).append(seed)
        plain: dict[str, Any] = {
            "made_of": dict(self.made_of),
            "episodes": {fault: _ranges(each) for fault, each in seeds.items()},
        }
        write_whole(folder / PLAN, json.dumps(plain, indent=2) + "\n")

    @classmethod
    def read(cls, folder: Path) -> Wanted | None:
        """What `write` wrote; None if it has not been called."""
        try:
            plain = json.loads((folder / PLAN).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        episodes = [
            (seed, fault or None)
            for fault, text in plain["episodes"].items()
            for seed in parse_seeds(text)
        ]
        return cls(tuple(episodes), plain["made_of"])


@dataclass(frozen=True, slots=True)
class Plan:
    """How the episodes of one tree are run; the fields are those of `EpisodeSpec`.

    record: "failures", "all" or "none".
    """

    tree: str
    wanted: Wanted
    world: str | None = None
    robot: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    max_time: float = 600.0
    referee: bool = True
    goal: Any = None
    limit: float = 900.0
    record: str = "none"
    map: str | None = None
    names: str | None = None

    def specs(self, rows: Mapping[str, Row], folder: Path) -> list[EpisodeSpec]:
        """The episodes that have no row yet. folder: of the results; records go below it."""
        found = []
        for episode in self.wanted.episodes:
            key = self.wanted.key(episode)
            if key not in rows:
                found.append(self._spec(key, *episode, folder))
        return found

    def of(self, wanted: Wanted) -> Plan:
        """The same for other episodes."""
        return replace(self, wanted=wanted)

    def _spec(self, key: str, seed: int, fault: str | None, folder: Path) -> EpisodeSpec:
        place = None
        if self.record != "none":
            place = str(folder / RECORDS / record_name(seed, fault, key))
        return EpisodeSpec(
            key,
            self.tree,
            seed,
            self.world,
            self.robot,
            dict(self.values),
            self.max_time,
            self.referee,
            self.goal,
            fault,
            place,
            self.limit,
            self.map,
            self.names,
            self.wanted.made_of,
        )


def record_name(seed: int, fault: str | None, key: str) -> str:
    """A folder's name for an episode: `seed-12-camera.dead-1f3a…`."""
    kind = "" if fault is None else "-" + "".join(c for c in fault if c.isalnum() or c in "._")
    return f"seed-{seed}{kind[:60]}-{key[:8]}"


def _ranges(seeds: Sequence[int]) -> str:
    """Seeds as `parse_seeds` reads them, in their order."""
    runs: list[list[int]] = []
    for seed in seeds:
        if runs and seed == runs[-1][1]:
            runs[-1][1] += 1
        else:
            runs.append([seed, seed + 1])
    return ",".join(f"{first}:{end}" for first, end in runs)
