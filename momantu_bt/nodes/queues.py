"""LoopInt, LoopDouble, LoopString, LoopBool: run the child once for each item of a queue.

| child returns   | the loop                                                  |
|-----------------|-----------------------------------------------------------|
| SUCCESS SKIPPED | RUNNING; the next tick takes the next item                |
| FAILURE         | FAILURE                                                   |
| RUNNING         | RUNNING                                                   |

When the queue is empty, at the start or later, the node ends with the status `if_empty`. The node
copies the queue when it starts; the list on the blackboard is not changed.
"""

from __future__ import annotations

from collections import deque
from typing import Any, Literal

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, Status
from momantu_bt.failure import FAILED
from momantu_bt.tree.catalogue.flow import again, perhaps
from momantu_bt.tree.catalogue.spec import NodeSpec, decorator, input_port, output_port
from momantu_bt.values.kinds import Queue


def _spec(type_: str, yaml: str, item: type) -> NodeSpec:
    return decorator(
        type_,
        yaml,
        "Takes item after item from a queue and runs the child for each, until it fails.",
        input_port("queue", Queue[item], "a list, or a text such as `1;2;3`"),  # type: ignore[valid-type]
        input_port(
            "if_empty",
            Literal["SUCCESS", "FAILURE", "SKIPPED"],
            "the result when the queue is empty, at the start or in the end",
            "SUCCESS",
        ),
        output_port("value", item, "the key that holds the item", None),
        modifier=False,
        item=("value", "queue"),
        flow=again(perhaps),
    )


class QueueLoop(Decorator):
    """Base of the four loops. value: the output for the current item; None: not connected."""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.value = parts.outputs().get("value")
        self.left: deque[Any] = deque()
        self.in_round = False

    def step(self) -> Status:
        """Take the next item unless the child is running, then tick the child."""
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
        if status.completed:
            self.child.reset()
        return self.pass_on(FAILURE) if status is FAILURE else RUNNING

    @property
    def note(self) -> str:
        """The number of items left."""
        return f"{len(self.left)} left"

    def clear(self) -> None:
        """Forget the queue; the next start reads it again."""
        self.left.clear()
        self.in_round = False

    def _empty(self) -> Status:
        ending = Status[self.inputs["if_empty"]]
        return self.fail(FAILED, "its queue is empty") if ending is FAILURE else ending


class LoopInt(QueueLoop):
    """A loop over integers."""

    spec = _spec("LoopInt", "loop_int", int)


class LoopDouble(QueueLoop):
    """A loop over numbers."""

    spec = _spec("LoopDouble", "loop_number", float)


class LoopString(QueueLoop):
    """A loop over texts."""

    spec = _spec("LoopString", "loop_text", str)


class LoopBool(QueueLoop):
    """A loop over booleans."""

    spec = _spec("LoopBool", "loop_bool", bool)
