"""A recorded run as values."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from momantu_bt.engine.role import Role
from momantu_bt.failure import FailureValue


@dataclass(frozen=True, slots=True)
class NodeInfo:
    """One node of the tree. type: the built-in's name, the skill's or the subtree's.

    index: its number in the order of the file; parent: that of the node above it. label: the node
    in one line, as the file has it. role: how it is drawn and told of.
    """

    index: int
    name: str
    type: str
    place: str
    depth: int
    parent: int | None
    label: str
    role: Role = Role.PLAIN


@dataclass(frozen=True, slots=True)
class ChangeRecord:
    """A node's status changed, or its note did while it was RUNNING. failure: with FAILURE."""

    node: int
    status: str
    note: str
    failure: FailureValue | None


@dataclass(frozen=True, slots=True)
class StepRecord:
    """One step of one skill. outputs: the values, by port, that are new since its last step."""

    node: int
    status: str
    phase: str
    failure: FailureValue | None
    outputs: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class TickRecord:
    """One tick. Tick 0 has the values that the run begins with.

    writes: cells with what was written, in order. reads: what came from outside, by its key, in
    order; `Refused` where it was a failure. issued: actuators with their goals, None to stop; the
    same object where the same was commanded again. state: a digest of what the robot reported,
    empty without a robot. settling: the tree had ended and the robot came to rest; the first such
    record has the number of the last tick, and in it everything is halted. notes, labels: by node,
    those that are new and that `changes` does not say: what a running node is at, and its line with
    the values of its newest start.
    """

    number: int
    now: float
    changes: tuple[ChangeRecord, ...] = ()
    writes: tuple[tuple[str, Any], ...] = ()
    reads: tuple[tuple[str, Any], ...] = ()
    issued: tuple[tuple[str, Any], ...] = ()
    state: str = ""
    steps: tuple[StepRecord, ...] = ()
    settling: bool = False
    notes: tuple[tuple[int, str], ...] = ()
    labels: tuple[tuple[int, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Recording:
    """A whole record.

    about: what `/run` says: format, tree, main, world, robot, seed, options, values, versions,
    unix_time. files: texts by name; `kinds` says of each whether it is a tree, values, a
    substitution, the site or a world's. report: as in `report.json`, None when the run was cut
    off. complete: the log has its end.
    """

    folder: Path
    about: Mapping[str, Any]
    files: Mapping[str, str]
    nodes: tuple[NodeInfo, ...]
    ticks: tuple[TickRecord, ...]
    report: Mapping[str, Any] | None
    complete: bool
    kinds: Mapping[str, str] = field(default_factory=dict)
    raw: Mapping[str, tuple[tuple[float, bytes], ...]] = field(default_factory=dict, repr=False)

    def topics(self) -> tuple[str, ...]:
        """Topics of all channels that hold a message, in the order of their names."""
        return tuple(sorted(self.raw))

    def messages(self, topic: str) -> Iterator[tuple[float, Mapping[str, Any]]]:
        """Messages of a channel as JSON data, with the seconds of the world's clock."""
        for time, text in self.raw.get(topic, ()):
            yield time, json.loads(text)
