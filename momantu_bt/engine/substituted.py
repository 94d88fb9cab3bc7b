"""Nodes that replace those of the tree file: by a rule for a test, or because of `disabled`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.substitute.substitution import Result


class Substituted(TreeNode):
    """Returns the results that a test's rules give, each as often as they say; then runs its child.

    The child is the replaced node, or the one that runs instead. Its conditions are moved to this
    node. replaced: whether the node itself never runs.
    """

    def __init__(
        self, parts: Parts, *, results: Sequence[Result], outputs: Mapping[str, Cell]
    ) -> None:
        super().__init__(parts)
        self.results = tuple(results)
        self.outputs = dict(outputs)
        self.at = self.given = 0
        self.result: Result | None = None
        self.replaced = not self.kids or self.kids[0].model.type != self.model.type
        self.begun = 0.0

    @property
    def is_itself(self) -> bool:
        """Whether the rules are used up, so that the child runs."""
        return self.at >= len(self.results)

    @property
    def role(self) -> Role:
        """Its role in displays: an action, whatever node it replaces."""
        return Role.ACT

    @property
    def plan(self) -> tuple[tuple[str, bool], ...]:
        """Nothing: its one child, if any, is the node that it replaces."""
        return ()

    @property
    def around(self) -> str:
        """Nothing: it has a line of its own, whatever it replaces."""
        return ""

    @property
    def note(self) -> str:
        """Text that says that the node is replaced."""
        plain = self.is_itself and self.result is None and not self.replaced
        return "" if plain else "substituted"

    def step(self) -> Status:
        """Begin the next result, or continue with the current one."""
        if self.state is not RUNNING:
            self._next()
        self.state = RUNNING
        if self.result is None:
            return self._itself()
        if self.result.status == "RUNNING":
            return RUNNING
        if self.context.now < self.begun + self.result.delay - CLOCK_SLACK:
            return RUNNING
        return self._end_with(self.result)

    def _next(self) -> None:
        self.result, self.begun = None, self.context.now
        if self.is_itself:
            return
        self.result = self.results[self.at]
        self.given += 1
        if self.given == self.result.times:
            self.at, self.given = self.at + 1, 0

    def _end_with(self, result: Result) -> Status:
        if result.status == "SKIPPED":
            return SKIPPED
        if result.status == "FAILURE":
            return self.fail(result.code, result.message or "a rule of the test says so")
        for name, value in result.outputs.items():
            if name in self.outputs:
                self.outputs[name].store(value)
        return SUCCESS

    def _itself(self) -> Status:
        child = self.kids[0]
        status = child.execute()
        if status.completed:
            child.reset()
        return self.fail_with(self.failure_of(child)) if status is FAILURE else status


class Disabled(TreeNode):
    """A node that the tree file disables: always SKIPPED, never started, nothing built below."""

    def execute(self) -> Status:
        """SKIPPED; this does not count as a run."""
        status = super().execute()
        self.runs = 0
        return status

    def step(self) -> Status:
        """SKIPPED."""
        return SKIPPED
