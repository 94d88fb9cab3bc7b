"""The base class of all nodes: status, conditions, halting and bookkeeping.

Nodes tick and stop as in BehaviorTree.CPP 4: `execute` evaluates the conditions, calls `step`, and
runs the scripts for the end (`on_success`, `on_failure`, `after`). A node has two statuses. Parents
use `state`: IDLE, RUNNING, or the result until the parent resets it. Displays use `shown`, the
newest result. It becomes IDLE again when a node above restarts; the journal has no entry for that.
"""

from __future__ import annotations

import traceback
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.changes import Change
from momantu_bt.engine.conditions import Conditions
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.ports import Inputs, Output, cell_of, inputs_of, outputs_of
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.errors import MomantuError
from momantu_bt.failure import FAILED, SCRIPT_ERROR, Failure, FailureValue, checked_code
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import NODES, NodeSpec
from momantu_bt.tree.model import Node, Reference
from momantu_bt.tree.script import ScriptError
from momantu_bt.tree.show.printing import around, plan, text


class BuildError(MomantuError):
    """Nodes cannot be built from a model. The checker finds all such mistakes before."""


_RESULTS = (RUNNING, SUCCESS, FAILURE, SKIPPED)
"""What `step` may return."""


def ticked_in(error: BaseException) -> TreeNode | None:
    """The innermost node whose tick or halt raised an exception; None if no node did."""
    owners = (frame.f_locals.get("self") for frame, _ in traceback.walk_tb(error.__traceback__))
    return next((each for each in reversed([*owners]) if isinstance(each, TreeNode)), None)


class _Top:
    """The parent of the root: it never restarts."""

    runs = 0


_TOP = _Top()


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts that a node is built from, such as its children and its ports.

    kids: its children, then the handlers' nodes. answers: the codes and the node of each handler;
    the node None means try again. caught: the cell that handlers read as `$failure`.
    """

    model: Node
    context: RunContext
    board: Board
    ports: Mapping[str, Port] = field(default_factory=dict)
    kids: tuple[TreeNode, ...] = ()
    conditions: Conditions | None = None
    answers: tuple[tuple[tuple[str, ...], TreeNode | None], ...] = ()
    caught: Cell | None = None

    def inputs(self, *keys: str) -> Inputs:
        """Readers of its inputs. keys: inputs that read the key of the same name by default.

        Raises:
            ConversionError: a literal does not fit its port.
        """
        defaults = {name: Reference(name) for name in keys}
        return inputs_of(self.ports, {**defaults, **self.model.ports}, self.board)

    def outputs(self) -> dict[str, Output]:
        """Its outputs that are connected to keys, by port name."""
        return outputs_of(self.ports, self.model.ports, self.board)

    def key(self, port: str) -> Cell:
        """The cell of the key that a port names.

        Raises:
            BuildError: the port does not name a key.
        """
        value = self.model.ports.get(port)
        if not isinstance(value, Reference):
            raise BuildError(f"{self.model.place}: {self.model.type} needs `{port}: $key`")
        return cell_of(value, self.board)


class TreeNode:
    """One node of a running tree. Subclasses define `step`, and `clear` to reset their state.

    spec: the declaration of this kind of node. model: the node as the tree file defines it. label:
    one line of text for displays; after the start it includes the inputs' values. index: its number
    in file order. runs, failures, ticks: how often it started, failed and was ticked. seconds: how
    long it was active, by the world's clock.
    """

    spec: ClassVar[NodeSpec]

    def __init__(self, parts: Parts) -> None:
        self.state = IDLE
        self._shown = IDLE
        self._shown_in_run = 0
        self._above: TreeNode | _Top = _TOP
        self.model = parts.model
        self.name = _name(parts.model)
        self.label = text(parts.model)
        self.context = parts.context
        self.kids = parts.kids
        self.conditions = parts.conditions
        self.failure: FailureValue | None = None
        self._raised: FailureValue | None = None
        self.place = f"{parts.model.place.file}:{parts.model.place.line}"
        self.index = 0
        self.depth = 0
        self.runs = self.failures = self.ticks = 0
        self.seconds = 0.0
        self.started_at: float | None = None
        self.ticked_at = 0
        for child in self.kids:
            child._above = self
        self.below: tuple[TreeNode, ...] = tuple(
            node for child in self.kids for node in (child, *child.below)
        )

    # Methods that subclasses define.

    @abstractmethod
    def step(self) -> Status:
        """One tick of the node itself, after its conditions were evaluated."""

    def clear(self) -> None:
        """Reset progress (indices, counts, timers); called when the node is halted."""

    def renew(self) -> None:
        """Reset state that is kept after an end, such as RoundRobin's index; for a recovery."""

    @property
    def note(self) -> str:
        """Text to show beside the name while it runs, such as a phase or the number of tries."""
        return ""

    @property
    def role(self) -> Role:
        """Its role in displays."""
        return Role.PLAIN

    @property
    def shown_children(self) -> tuple[tuple[str, bool], ...]:
        """Its children and handlers in displays; see `printing.plan`."""
        return plan(self.model)

    @property
    def around(self) -> str:
        """Its words if displays show it on its child's line; see `printing.around`."""
        return around(self.model) if self.kids else ""

    @property
    def answered(self) -> tuple[int, ...]:
        """For each handler, how many failures it has handled."""
        return ()

    @property
    def above(self) -> TreeNode | None:
        """The node that ticks it; None for the root."""
        return self._above if isinstance(self._above, TreeNode) else None

    # Methods that parents call.

    def execute(self) -> Status:
        """Tick the node and return its status, SKIPPED included."""
        context = self.context
        self.ticks += 1
        self.ticked_at = context.tick
        try:
            if self.conditions is not None:
                new = self._conditioned(self.conditions)
            else:
                if self.state is not RUNNING:
                    self.runs += 1
                    self.failure = None
                new = self.step()
        except (Failure, ScriptError) as error:
            new = self._broken(error)
        if new is RUNNING:
            if self.started_at is None:
                self.started_at = context.now
        elif self.started_at is not None:
            self._count_seconds()
        if new is FAILURE:
            self.failures += 1
        if new is not SKIPPED:
            self.state = new
        if new is not self._shown or self._shown_in_run != self._above.runs:
            if new not in _RESULTS:
                names = ", ".join(each.value for each in _RESULTS)
                raise TypeError(f"step() returned {new!r}; expected one of {names}")
            self.show(new)
        return new

    def halt(self) -> None:
        """Stop this node and all nodes below it; safe to call in any state."""
        self.reset_children()
        self.clear()
        self._count_seconds()
        self.state = IDLE
        if self._shown is RUNNING:
            self.show(IDLE)

    def halt_node(self) -> None:
        """Halt, then run `on_halt`; if that script fails, only publish a remark."""
        self.halt()
        if self.conditions is not None:
            try:
                self.conditions.halted()
            except ScriptError as error:
                self.context.remark(f"{self.where}: on_halt: {error}")

    def reset(self) -> None:
        """Set `state` to IDLE; halt the node first if it is running."""
        if self.state is RUNNING:
            self.halt_node()
        self.state = IDLE

    def reset_children(self) -> None:
        """Reset every child."""
        for child in self.kids:
            if child.state is RUNNING:
                child.reset()
            else:
                child.state = IDLE

    @property
    def shown(self) -> Status:
        """The newest result, for displays."""
        node = self
        while isinstance(node._above, TreeNode):
            if node._shown_in_run != node._above.runs:
                return IDLE
            node = node._above
        return self._shown

    def show(self, status: Status) -> None:
        """Set the shown status and record it in the journal; with RUNNING also a changed `note`."""
        self._shown = status
        self._shown_in_run = self._above.runs
        note = self.note if status is RUNNING else ""
        failure = self.failure if status is FAILURE else None
        self.context.changes.append(Change(self, status, note, failure))

    # Names and failures.

    @property
    def where(self) -> str:
        """`name (file:line)`, for messages."""
        return f"{self.name} ({self.place})"

    def fail_with(self, value: FailureValue) -> Status:
        """Fail with a failure, usually a child's."""
        self.failure = value
        return FAILURE

    def fail(self, code: str, message: str, cause: FailureValue | None = None) -> Status:
        """Fail with a failure of this node; the previous value is reused when it is the same.

        Raises:
            ValueError: the code is not upper-case words joined by underscores.
        """
        value = self._raised
        if value is None or (code, message, cause) != (value.code, value.message, value.cause):
            value = self._raised = self.own(FailureValue(checked_code(code), message, cause=cause))
        self.failure = value
        return FAILURE

    def own(self, value: FailureValue) -> FailureValue:
        """A copy of the failure with this node's name, type and place."""
        kind = self.model.target or self.model.type
        return value.at(self.name, self.place, kind)

    def failure_of(self, child: TreeNode) -> FailureValue:
        """The failure of a child that returned FAILURE."""
        return child.failure or child.own(FailureValue(FAILED, "failed without a reason"))

    # Bookkeeping.

    def _conditioned(self, conditions: Conditions) -> Status:
        """One tick, with the conditions before it and the scripts after an end."""
        new = conditions.before(self.state)
        if new is None:
            if self.state is not RUNNING:
                self.runs += 1
                self.failure = None
            new = self.step()
        elif new is SKIPPED and self.state is RUNNING:
            self.halt_node()
        elif new is FAILURE:
            self.fail(FAILED, f"its condition {conditions.reason('fail_if')}")
        if new is SUCCESS or new is FAILURE:
            conditions.after(new)
        return new

    def _count_seconds(self) -> None:
        if self.started_at is not None:
            self.seconds += self.context.now - self.started_at
            self.started_at = None

    def _broken(self, error: Failure | ScriptError) -> Status:
        self.reset_children()
        self.clear()
        value = (
            error.value if isinstance(error, Failure) else FailureValue(SCRIPT_ERROR, str(error))
        )
        return self.fail_with(self.own(value))


def _name(model: Node) -> str:
    """The node's name; if it has none, the subtree's, its name in YAML, or the skill's."""
    spec = NODES.get(model.type)
    return model.name or model.target or (model.type if spec is None else spec.yaml[0])
