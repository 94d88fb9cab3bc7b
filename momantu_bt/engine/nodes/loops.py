"""Repeat, RetryUntilSuccessful, KeepRunningUntilFailure, ForEach, RunOnce: the child again.

| child returns | Repeat            | RetryUntilSuccessful | KeepRunningUntilFailure |
|---------------|-------------------|----------------------|-------------------------|
| SUCCESS       | again; in the end SUCCESS | SUCCESS      | again                   |
| FAILURE       | FAILURE           | again; in the end FAILURE | FAILURE            |
| RUNNING       | RUNNING           | RUNNING              | RUNNING                 |
| SKIPPED       | SKIPPED           | SKIPPED              | RUNNING                 |

After a round that began and ended within one tick a tick passes, so that what is around can
interrupt; after a longer one the next begins at once. -1 rounds are without end.
"""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.engine.tries import with_tries


class Repeat(Decorator):
    """Runs the child again when it succeeds."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.count = 0

    def step(self) -> Status:
        """Rounds until the child runs, ends otherwise, or a tick is to pass."""
        cycles: int = self.inputs["cycles"]
        self.state = RUNNING
        while self.count < cycles or cycles == -1:
            fresh = self.child.state is IDLE
            status = self.child.execute()
            if status is RUNNING:
                return RUNNING
            self.child.reset()
            if status is SKIPPED:
                return SKIPPED
            if status is FAILURE:
                self.count = 0
                return self.pass_on(FAILURE)
            self.count += 1
            if fresh and (self.count < cycles or cycles == -1):
                return RUNNING
        self.count = 0
        return SUCCESS

    @property
    def note(self) -> str:
        """Which round it is."""
        return f"round {self.count + 1}"

    def clear(self) -> None:
        """No rounds yet."""
        self.count = 0


class RetryUntilSuccessful(Decorator):
    """Runs the child again when it fails; `attempts` counts all tries."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.count = 0

    def step(self) -> Status:
        """Tries until the child runs, ends otherwise, or a tick is to pass."""
        attempts: int = self.inputs["attempts"]
        self.state = RUNNING
        while self.count < attempts or attempts == -1:
            fresh = self.child.state is IDLE
            status = self.child.execute()
            if status is RUNNING:
                return RUNNING
            self.child.reset()
            if status is not FAILURE:
                self.count = 0 if status is SUCCESS else self.count
                return status
            self.count += 1
            attempts = self.inputs["attempts"]
            if fresh and (self.count < attempts or attempts == -1):
                return RUNNING
        tries, self.count = self.count, 0
        return self.fail_with(with_tries(self, self.failure_of(self.child), tries, attempts))

    @property
    def note(self) -> str:
        """Which try it is."""
        return f"try {self.count + 1}"

    def clear(self) -> None:
        """No tries yet."""
        self.count = 0


class KeepRunningUntilFailure(Decorator):
    """Runs the child again and again until it fails."""

    def step(self) -> Status:
        """One round at most."""
        self.state = RUNNING
        status = self.child.execute()
        if status is FAILURE or status is SUCCESS:
            self.child.reset()
        if status is FAILURE:
            return self.pass_on(FAILURE)
        return RUNNING


class ForEach(Decorator):
    """Runs the child for each item of a list.

    The items are read when it starts; `as` holds the item of the round. SUCCESS after the last
    item (at once for an empty list), FAILURE with the child's; a skipped round counts as done.
    """

    def __init__(self, *arguments: Any, inputs: Inputs, item: Cell, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.item = item
        self.items: tuple[Any, ...] | None = None
        self.at = 0

    def step(self) -> Status:
        """One round at most."""
        if self.items is None:
            self.items, self.at = tuple(self.inputs["in"]), 0
        self.state = RUNNING
        if self.at < len(self.items):
            if self.child.state is IDLE:
                self.item.write(self.items[self.at])
            status = self.child.execute()
            if status is RUNNING:
                return RUNNING
            self.child.reset()
            if status is FAILURE:
                self.items = None
                return self.pass_on(FAILURE)
            self.at += 1
            if self.at < len(self.items):
                return RUNNING
        self.items = None
        return SUCCESS

    def clear(self) -> None:
        """The list is read anew."""
        self.items = None


class RunOnce(Decorator):
    """Runs the child to its end once in the life of the tree; then SKIPPED, or that end again."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.result: Status | None = None

    def step(self) -> Status:
        """Tick the child until its first end."""
        if self.result is not None:
            if self.inputs["then_skip"]:
                return SKIPPED
            return self.pass_on(self.result)
        self.state = RUNNING
        status = self.child.execute()
        if status.completed:
            self.result = status
            self.child.reset()
        return self.pass_on(status)
