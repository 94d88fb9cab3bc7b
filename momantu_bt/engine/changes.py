"""The journal of statuses: which nodes changed in a tick, and what others see of a node."""

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
        """Its role for a reader."""
        ...

    @property
    def note(self) -> str:
        """The text beside it while it runs."""
        ...

    @property
    def where(self) -> str:
        """`name (file:line)`, for messages."""
        ...

    @property
    def above(self) -> SeenNode | None:
        """The node around it; None of the root."""
        ...

    @property
    def kids(self) -> Sequence[SeenNode]:
        """Its children."""
        ...


class Change(NamedTuple):
    """A node's status changed, or its note did while it was RUNNING.

    failure: why, with FAILURE; the node itself may have started again within the tick.
    """

    node: SeenNode
    status: Status
    note: str
    failure: FailureValue | None
