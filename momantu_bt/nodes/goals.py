"""GoalUpdated, GoalUpdatedController, GoalUpdater: Nav2's nodes that look at the goal."""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, INPUT_MISSING, Failure
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.flow import again, as_child
from momantu_bt.tree.catalogue.spec import Dialect, decorator, input_port, leaf, output_port

GOAL_PORTS = (
    input_port("goal", object, "the goal that is watched; $goal unless given", None),
    input_port("goals", object, "the goals that are watched; $goals unless given", None),
)
"""Ports of nodes that look at the goal."""
GOAL_NAMES = ("goal", "goals")
"""Their names, which are also those of the keys that they mean unless they are given."""


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

    spec = leaf(
        "GoalUpdated",
        "goal_updated",
        "Succeeds when the goal has changed since the last time, fails when it has not.",
        *GOAL_PORTS,
        may_be_empty=GOAL_NAMES,
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.goals = Goals(parts.inputs(*GOAL_NAMES))

    def step(self) -> Status:
        """Look."""
        if self.state is IDLE:
            self.goals.remember()
        elif self.goals.have_changed():
            return SUCCESS
        return self.fail(FAILED, "the goal has not changed")


class GoalUpdatedController(Decorator):
    """Starts the child first, and again whenever a goal has changed; RUNNING in between."""

    spec = decorator(
        "GoalUpdatedController",
        "goal_updated_controller",
        "Starts the child first and at each new goal.",
        *GOAL_PORTS,
        may_be_empty=GOAL_NAMES,
        dialect=Dialect.NAV2,
        flow=again(as_child),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.goals = Goals(parts.inputs(*GOAL_NAMES))
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


_SOURCES = {"output_goal": "input_goal", "output_goals": "input_goals"}


class GoalUpdater(Decorator):
    """Writes the inputs that have a value to the outputs of their names, then ticks the child."""

    spec = decorator(
        "GoalUpdater",
        "goal_updater",
        "Hands a goal on to the child; a goal from elsewhere would take its place.",
        input_port("input_goal", object, "the goal", None),
        input_port("input_goals", object, "the goals", None),
        output_port("output_goal", object, "the key that the child reads", None),
        output_port("output_goals", object, "the key that the child reads", None),
        may_be_empty=("input_goal", "input_goals"),
        copies=_SOURCES,
        dialect=Dialect.NAV2,
        flow=as_child,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.outputs = parts.outputs()

    def step(self) -> Status:
        """Hand on what there is, and tick the child."""
        for name, output in self.outputs.items():
            value = peek(self.inputs, _SOURCES[name])
            if value is not None and value is not MISSING:
                output.write(value)
        status = self.child.execute()
        if status is not RUNNING:
            self.child.reset()
        return self.pass_on(status)
