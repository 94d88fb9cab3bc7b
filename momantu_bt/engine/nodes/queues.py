"""LoopInt, LoopDouble, LoopString, LoopBool: the child once for each item of a queue.

| child returns   | the loop                                                  |
|-----------------|-----------------------------------------------------------|
| SUCCESS SKIPPED | RUNNING; the next tick takes the next item                |
| FAILURE         | FAILURE                                                   |
| RUNNING         | RUNNING                                                   |

When no item is left (or there was none) it ends with `if_empty`. The queue is read when the node
starts; what is on the blackboard keeps its items.
"""

from __future__ import annotations

from collections import deque
from typing import Any

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, Status
from momantu_bt.failure import FAILED


class QueueLoop(Decorator):
    """value: the cell that holds the item of the round, None where nothing is wired."""

    def __init__(self, *arguments: Any, inputs: Inputs, value: Cell | None, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.value = value
        self.left: deque[Any] = deque()
        self.in_round = False

    def step(self) -> Status:
        """Take an item unless the child is at work, then tick the child."""
        if self.state is IDLE:
            self.in_round = False
            self.left = deque(self.inputs["queue"])
        if not self.in_round:
            if not self.left:
                return self._empty()
            item = self.left.popleft()
            if self.value is not None:
                self.value.write(item)
        self.state = RUNNING
        status = self.child.execute()
        self.in_round = status is RUNNING
        if status is RUNNING:
            return RUNNING
        self.child.reset()
        return self.pass_on(FAILURE) if status is FAILURE else RUNNING

    @property
    def note(self) -> str:
        """How many items are waiting."""
        return f"{len(self.left)} left"

    def clear(self) -> None:
        """The queue is read anew."""
        self.left.clear()
        self.in_round = False

    def _empty(self) -> Status:
        ending = Status[self.inputs["if_empty"]]
        return self.fail(FAILED, "its queue is empty") if ending is FAILURE else ending
