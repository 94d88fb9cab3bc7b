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
    """One node of the tree. type: the name of the built-in, the skill or the subtree.

    index: its number in file order. parent: the number of its parent. label: the node in one line,
    as in the file. role: how displays show it. plan, around: its children and handlers, and the
    words of a decorator, as `printing.plan` and `printing.around` have them.
    """

    index: int
    name: str
    type: str
    place: str
    depth: int
    parent: int | None
    label: str
    role: Role = Role.PLAIN
    plan: tuple[tuple[str, bool], ...] = ()
    around: str = ""


@dataclass(frozen=True, slots=True)
class ChangeRecord:
    """A change of a node's status, or of its note while RUNNING. failure: set with FAILURE."""

    node: int
    status: str
    note: str
    failure: FailureValue | None


@dataclass(frozen=True, slots=True)
class StepRecord:
    """One step of one skill. outputs: by port, the values that changed since its last step."""

    node: int
    status: str
    phase: str
    failure: FailureValue | None
    outputs: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class TickRecord:
    """One tick. Tick 0 has the initial values of the run.

    writes: names of cells with the values written, in order. reads: answers from outside with their
    keys, in order; `Refused` for a failure. issued: actuators with their goals, None for a stop; a
    goal that is commanded again is the same object. state: a digest of the robot's state, empty
    without a robot. settling: the tree had ended and the robot came to rest; the first such record
    has the number of the last tick, and in it all nodes are halted. notes: by node, new notes that
    are not in `changes`. labels: by node, new lines with the values of the node's newest start.
    logs: by node, what its skill has logged.
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
    logs: tuple[tuple[int, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Recording:
    """A whole record.

    about: the message of `/run` with format, tree, main, world, robot, seed, options, values,
    versions and unix_time. files: texts by name. kinds: for each file, whether it is a tree,
    values, a substitution, the site or a file of the world. report: as in `report.json`; None if
    the run was cut off. complete: the log is not cut off.
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
        """Topics of all channels with messages, sorted by name."""
        return tuple(sorted(self.raw))

    def messages(self, topic: str) -> Iterator[tuple[float, Mapping[str, Any]]]:
        """Messages of a channel as JSON data, each with its time of the world's clock, s."""
        for time, text in self.raw.get(topic, ()):
            yield time, json.loads(text)
