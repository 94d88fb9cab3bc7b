"""A moment of a recorded run: every node as a display shows it, and the blackboard."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from momantu_bt.engine.role import Role
from momantu_bt.engine.status import IDLE, Status
from momantu_bt.failure import FailureValue
from momantu_bt.record.recording import NodeInfo, TickRecord


@dataclass(slots=True, eq=False)
class ShownNode:
    """A node of a record at one moment; displays and texts treat it like a node of a run."""

    info: NodeInfo
    label: str
    note: str = ""
    shown: Status = IDLE
    failure: FailureValue | None = None
    above: ShownNode | None = None
    kids: Sequence[ShownNode] = ()

    @property
    def index(self) -> int:
        """Its number in the order of the file."""
        return self.info.index

    @property
    def name(self) -> str:
        """Its name."""
        return self.info.name

    @property
    def depth(self) -> int:
        """Its depth in the tree."""
        return self.info.depth

    @property
    def role(self) -> Role:
        """Its role for a reader."""
        return self.info.role

    @property
    def shown_children(self) -> Sequence[tuple[str, bool]]:
        """The prefixes of its children and handlers."""
        return self.info.plan

    @property
    def around(self) -> str:
        """Its words if it is shown on its child's line."""
        return self.info.around


@dataclass(frozen=True, slots=True)
class Moment:
    """After a tick. index: the tick's in the record. nodes: by index. board: cells by name."""

    index: int
    tick: TickRecord
    nodes: tuple[ShownNode, ...]
    board: Mapping[str, object]

    @property
    def root(self) -> ShownNode:
        """The root."""
        return self.nodes[0]

    @property
    def written(self) -> tuple[str, ...]:
        """The cells that this tick wrote, in the order of writing."""
        return tuple(dict.fromkeys(cell for cell, _ in self.tick.writes))
