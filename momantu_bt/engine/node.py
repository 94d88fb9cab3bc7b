"""The base class of all nodes: status, conditions, halting and bookkeeping.

Nodes tick and stop as in BehaviorTree.CPP 4: `execute` asks the conditions, then `step`, then runs
the scripts that follow an end. `state` is what a parent decides by (IDLE, RUNNING, or an end not
yet collected); `shown` is the newest result, for people: it is IDLE again as soon as a node above
starts anew, without a change of its own in the journal.
"""

from __future__ import annotations

import traceback
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.changes import Change
from momantu_bt.engine.conditions import Conditions
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.ports import Inputs, Output, cell_of, inputs_of, outputs_of
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.errors import MomantuError
from momantu_bt.failure import FAILED, SCRIPT_ERROR, Failure, FailureValue
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import NODES, NodeSpec
from momantu_bt.tree.model import Node, Reference
from momantu_bt.tree.script import ScriptError
from momantu_bt.tree.show.printing import text


class BuildError(MomantuError):
    """The model cannot become nodes: the checker would have said so."""


_RESULTS = (RUNNING, SUCCESS, FAILURE, SKIPPED)
"""What `step` may return."""


def ticked_in(error: BaseException) -> TreeNode | None:
    """The innermost node in whose tick or halt an exception was raised; None outside of nodes."""
    owners = (frame.f_locals.get("self") for frame, _ in traceback.walk_tb(error.__traceback__))
    return next((each for each in reversed([*owners]) if isinstance(each, TreeNode)), None)


class _Top:
    """The parent of the root: it never restarts."""

    runs = 0


_TOP = _Top()


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts that a node is built from, such as its children and its ports.

    kids: its children, those of handlers after the others. answers: codes of each handler, and
    its node; None just tries again. caught: the cell that handlers see as `$failure`.
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
        """Readers of its inputs. keys: inputs that mean the keys of their names unless given.

        Raises:
            ConversionError: a literal does not fit its port.
        """
        defaults = {name: Reference(name) for name in keys}
        return inputs_of(self.ports, {**defaults, **self.model.ports}, self.board)

    def outputs(self) -> dict[str, Output]:
        """Its outputs that are wired, by port."""
        return outputs_of(self.ports, self.model.ports, self.board)

    def key(self, port: str) -> Cell:
        """The cell that a port is wired to.

        Raises:
            BuildError: the port is not wired to a key.
        """
        value = self.model.ports.get(port)
        if not isinstance(value, Reference):
            raise BuildError(f"{self.model.place}: {self.model.type} needs `{port}: $key`")
        return cell_of(value, self.board)


class TreeNode:
    """One node of a running tree. Subclasses write `step`, and `clear` for what they remember.

    spec: what a kind of node says of itself. model: what the tree file says. label: the same in
    one line, with values once it has started. index: its number in the order of the file.
    runs, failures, ticks, seconds: how often it started, failed, was ticked, and for how long
    it was active by the world's clock.
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

    # what subclasses write

    @abstractmethod
    def step(self) -> Status:
        """One tick of the node itself; its conditions have been asked."""

    def clear(self) -> None:
        """Forget progress (indices, counts, timers): the node is being halted."""

    def renew(self) -> None:
        """Forget what outlasts an end (RoundRobin's position): a recovery starts from scratch."""

    @property
    def note(self) -> str:
        """The text beside the name while it runs: a phase, a count of tries."""
        return ""

    @property
    def role(self) -> Role:
        """Its role for a reader."""
        return Role.PLAIN

    @property
    def answered(self) -> tuple[int, ...]:
        """The number of failures that each of its handlers has handled."""
        return ()

    @property
    def above(self) -> TreeNode | None:
        """The node that ticks it; None of the root."""
        return self._above if isinstance(self._above, TreeNode) else None

    # what parents call

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
        """End whatever is running here and below; safe to call in any state."""
        self.reset_children()
        self.clear()
        self._count_seconds()
        self.state = IDLE
        if self._shown is RUNNING:
            self.show(IDLE)

    def halt_node(self) -> None:
        """Halt, then run `on_halt`; a script that fails there is remarked on and passed over."""
        self.halt()
        if self.conditions is not None:
            try:
                self.conditions.halted()
            except ScriptError as error:
                self.context.remark(f"{self.where}: on_halt: {error}")

    def reset(self) -> None:
        """Back to IDLE, halting it when it is running."""
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
        """The newest result, for people."""
        node = self
        while isinstance(node._above, TreeNode):
            if node._shown_in_run != node._above.runs:
                return IDLE
            node = node._above
        return self._shown

    def show(self, status: Status) -> None:
        """Change the shown status and note it in the journal; RUNNING again for a new `note`."""
        self._shown = status
        self._shown_in_run = self._above.runs
        note = self.note if status is RUNNING else ""
        failure = self.failure if status is FAILURE else None
        self.context.changes.append(Change(self, status, note, failure))

    # names and failures

    @property
    def where(self) -> str:
        """`name (file:line)`, for messages."""
        return f"{self.name} ({self.place})"

    def fail_with(self, value: FailureValue) -> Status:
        """Fail with a failure, usually a child's."""
        self.failure = value
        return FAILURE

    def fail(self, code: str, message: str, cause: FailureValue | None = None) -> Status:
        """Fail with a failure of this node's own; the same one again when nothing differs."""
        value = self._raised
        if value is None or (code, message, cause) != (value.code, value.message, value.cause):
            value = self._raised = self.own(FailureValue(code, message, cause=cause))
        self.failure = value
        return FAILURE

    def own(self, value: FailureValue) -> FailureValue:
        """The failure as one of this node: with its name, type and place."""
        kind = self.model.target or self.model.type
        return replace(value, node=self.name, place=self.place, node_type=kind)

    def failure_of(self, child: TreeNode) -> FailureValue:
        """Why a child that returned FAILURE did so."""
        return child.failure or child.own(FailureValue(FAILED, "failed without a reason"))

    # bookkeeping

    def _conditioned(self, conditions: Conditions) -> Status:
        """One tick with the conditions asked before it and the scripts run after an end."""
        new = conditions.before(self.state)
        if new is None:
            if self.state is not RUNNING:
                self.runs += 1
                self.failure = None
            new = self.step()
        elif new is SKIPPED and self.state is RUNNING:
            self.halt_node()
        elif new is FAILURE:
            self.fail(FAILED, f"its condition `{conditions.text('fail_if')}` holds")
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
    """Its own name, else the subtree's, else its spelling in YAML, else the skill's."""
    spec = NODES.get(model.type)
    return model.name or model.target or (model.type if spec is None else spec.yaml[0])
