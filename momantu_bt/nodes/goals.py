"""GoalUpdated, GoalUpdatedController, GoalUpdater: Nav2's nodes that watch or pass on the goal."""

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
"""Ports of nodes that watch the goal."""
GOAL_NAMES = ("goal", "goals")
"""The ports' names. A port that the tree leaves out reads the key of the same name."""


def peek(inputs: Inputs, name: str) -> Any:
    """An input's value; MISSING when its key has no value."""
    try:
        return inputs[name]
    except Failure as failure:
        if failure.value.code == INPUT_MISSING:
            return MISSING
        raise


class Goals:
    """Watches the keys goal and goals, and remembers their last values."""

    def __init__(self, inputs: Inputs) -> None:
        self._inputs = inputs
        self._last: tuple[Any, Any] = (MISSING, MISSING)

    def remember(self) -> None:
        """Remember the current values."""
        self._last = (peek(self._inputs, "goal"), peek(self._inputs, "goals"))

    def have_changed(self) -> bool:
        """Whether a value differs from the remembered one; then remember the current values."""
        last = self._last
        self.remember()
        return not all(_same(new, old) for new, old in zip(self._last, last, strict=True))


def _same(left: Any, right: Any) -> bool:
    if left is right:
        return True
    try:
        return bool(left == right)
    except ValueError:  # it holds arrays, which `==` cannot compare: count it as changed
        return False


class GoalUpdated(TreeNode):
    """SUCCESS when a goal has changed since the last tick, else FAILURE.

    In the first tick after a start it fails. A reactive parent resets it whenever another child
    runs, so there every tick is a first tick.
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
        """Compare the goal with its value in the last tick."""
        if self.state is IDLE:
            self.goals.remember()
        elif self.goals.have_changed():
            return SUCCESS
        return self.fail(FAILED, "the goal has not changed")


class GoalUpdatedController(Decorator):
    """Starts the child at its own start and whenever a goal changes; RUNNING in between."""

    spec = decorator(
        "GoalUpdatedController",
        "goal_updated_controller",
        "Runs the child at the start and again at each new goal.",
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
        """Tick the child if it is running or has to start."""
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
    """Copies the goal, the goals or both to other keys, then ticks the child.

    `input_goal` goes to `output_goal`, `input_goals` to `output_goals`. An input without a value is
    not copied.
    """

    spec = decorator(
        "GoalUpdater",
        "goal_updater",
        "Copies a goal to the key that the child reads, then ticks the child.",
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
        """Copy the inputs that have a value, and tick the child."""
        for name, output in self.outputs.items():
            value = peek(self.inputs, _SOURCES[name])
            if value is not None and value is not MISSING:
                output.write(value)
        status = self.child.execute()
        if status is not RUNNING:
            self.child.reset()
        return self.pass_on(status)
