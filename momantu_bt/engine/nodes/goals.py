"""GoalUpdated, GoalUpdatedController, GoalUpdater: Nav2's nodes that look at the goal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, INPUT_MISSING, Failure
from momantu_bt.skill import MISSING


def peek(inputs: Inputs, name: str) -> Any:
    """An input's value; MISSING where its key has none."""
    try:
        return inputs[name]
    except Failure as failure:
        if failure.value.code == INPUT_MISSING:
            return MISSING
        raise


class Goals:
    """The goal and the goals that a node watches, and what they were when it last looked."""

    def __init__(self, inputs: Inputs) -> None:
        self._inputs = inputs
        self._last: tuple[Any, Any] = (MISSING, MISSING)

    def remember(self) -> None:
        """Take them as they are."""
        self._last = (peek(self._inputs, "goal"), peek(self._inputs, "goals"))

    def have_changed(self) -> bool:
        """Whether one of them differs from what was remembered; then they are remembered."""
        last = self._last
        self.remember()
        return not all(_same(new, old) for new, old in zip(self._last, last, strict=True))


def _same(left: Any, right: Any) -> bool:
    if left is right:
        return True
    try:
        return bool(left == right)
    except ValueError:  # arrays inside: what cannot be compared counts as new
        return False


class GoalUpdated(TreeNode):
    """SUCCESS when a goal has changed since the last tick, else FAILURE.

    At its start it looks for the first time and fails. A parent that resets its children (every
    reactive one while another child runs) starts it anew each time.
    """

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.goals = Goals(inputs)

    def step(self) -> Status:
        """Look."""
        if self.state is IDLE:
            self.goals.remember()
        elif self.goals.have_changed():
            return SUCCESS
        return self.fail(FAILED, "the goal has not changed")


class GoalUpdatedController(Decorator):
    """Starts the child first, and again whenever a goal has changed; RUNNING in between."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.goals = Goals(inputs)
        self.due = True

    def step(self) -> Status:
        """Tick the child when it is at work, or due."""
        if self.state is IDLE:
            self.goals.remember()
            self.due = True
        self.state = RUNNING
        self.due = self.goals.have_changed() or self.due
        if not self.due and self.child.state is not RUNNING:
            return RUNNING
        self.due = False
        return self.pass_on(self.child.execute())


class GoalUpdater(Decorator):
    """Writes the inputs that have a value to the outputs of their names, then ticks the child."""

    def __init__(
        self, *arguments: Any, inputs: Inputs, outputs: Mapping[str, Cell], **named: Any
    ) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.outputs = dict(outputs)

    def step(self) -> Status:
        """Hand on what there is, and tick the child."""
        for name, cell in self.outputs.items():
            value = peek(self.inputs, name.replace("output", "input"))
            if value is not None and value is not MISSING:
                cell.write(value)
        status = self.child.execute()
        if status is not RUNNING:
            self.child.reset()
        return self.pass_on(status)
