"""Merge folders of results of one bench that several machines ran."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path

from momantu_bt.bench.planning.made_of import difference
from momantu_bt.bench.planning.plan import PLAN, Wanted
from momantu_bt.bench.rows.spec import Row
from momantu_bt.bench.rows.store import RESULTS, StoreError, read_rows

DECIDED: tuple[str, ...] = ("ended", "status", "success", "unmet", "fingerprint", "sim_time_s")
DECIDED += ("tries", "incidents", "claims", "faults", "outcome")
"""Fields that an episode's key decides. Others describe the machine: its speed, its memory."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """One episode that ended differently in two folders. fields: those that differ."""

    seed: int
    fault: str | None
    folders: tuple[Path, Path]
    fields: tuple[str, ...]

    def __str__(self) -> str:
        """A sentence for people."""
        name = f"seed {self.seed}" + (f" of {self.fault}" if self.fault else "")
        first, second = self.folders
        return f"{name} differs between {first} and {second}: {', '.join(self.fields)}"


@dataclass(frozen=True, slots=True)
class Merged:
    """Several folders as one.

    wanted: all episodes that any folder planned. rows: by key, each once, in the order of `wanted`,
    without the rows in conflict, since nobody knows which is right. doubles: rows that an earlier
    folder also has, with equal results. others: rows of something else.
    """

    wanted: Wanted
    rows: Mapping[str, Row]
    conflicts: tuple[Conflict, ...]
    doubles: int
    others: int


def merge(folders: Sequence[Path]) -> Merged:
    """Read folders of results of one bench.

    Raises:
        StoreError: one is not a folder of results, or belongs to another bench than the first.
    """
    plans = [_plan(folder) for folder in folders]
    for folder, plan in zip(folders, plans, strict=True):
        _check_same(folders[0], plans[0], folder, plan)
    wanted = reduce(Wanted.united, plans)
    keys = {wanted.key(episode): None for episode in wanted.episodes}
    found: dict[str, tuple[Path, Row]] = {}
    conflicts: dict[str, Conflict] = {}
    doubles = others = 0
    for folder in folders:
        for row in read_rows(folder):
            key = row["key"]
            if key not in keys:
                others += 1
                continue
            before, other = found.setdefault(key, (folder, row))
            if fields := _differing(other, row):
                both = (before, folder)
                conflicts.setdefault(key, Conflict(row["seed"], row["fault"], both, fields))
            elif other is not row:
                doubles += 1
    rows = {key: found[key][1] for key in keys if key in found and key not in conflicts}
    return Merged(wanted, rows, tuple(conflicts.values()), doubles, others)


def _plan(folder: Path) -> Wanted:
    plan = Wanted.read(folder)
    if plan is None:
        raise StoreError(
            f"{folder} holds no results of a bench ({PLAN} and {RESULTS}); give the folders that "
            "`momantu-bt bench --out` wrote"
        )
    return plan


def _check_same(first: Path, plan: Wanted, folder: Path, other: Wanted) -> None:
    if differs := difference(plan.made_of, other.made_of):
        raise StoreError(
            f"{first} and {folder} are of different benches: {', '.join(differs)} differ; "
            "merge what was run with the same files, versions and options"
        )


def _differing(row: Row, other: Row) -> tuple[str, ...]:
    return tuple(name for name in DECIDED if row.get(name) != other.get(name))
