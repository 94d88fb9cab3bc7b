"""The status of a node: the five of BehaviorTree.CPP."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """IDLE before the first tick and after a halt. SKIPPED is returned, but not kept as a state."""

    IDLE = "IDLE"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"
    SKIPPED = "SKIPPED"

    @property
    def completed(self) -> bool:
        """Whether it is SUCCESS or FAILURE."""
        return self is Status.SUCCESS or self is Status.FAILURE


IDLE, RUNNING, SUCCESS, FAILURE, SKIPPED = Status
