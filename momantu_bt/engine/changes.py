"""The status changes of a tick, and the part of a node that observers see."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from momantu_bt.engine.role import Role
from momantu_bt.engine.status import Status
from momantu_bt.failure import FailureValue


class SeenNode(Protocol):
    """A node as observers of a run see it; every `TreeNode` implements it."""

    name: str
    label: str
    place: str
    index: int

    @property
    def role(self) -> Role:
        """Its role in displays."""
        ...

    @property
    def note(self) -> str:
        """Text to show beside it while it runs."""
        ...

    @property
    def where(self) -> str:
        """`name (file:line)`, for messages."""
        ...

    @property
    def above(self) -> SeenNode | None:
        """Its parent; None for the root."""
        ...

    @property
    def kids(self) -> Sequence[SeenNode]:
        """Its children."""
        ...


class Change(NamedTuple):
    """A change of a node's status, or of its note while it was RUNNING.

    failure: with FAILURE, the reason. It is kept here as the node may restart in the same tick.
    """

    node: SeenNode
    status: Status
    note: str
    failure: FailureValue | None
