"""Recover and Handle: a failure's code decides what happens next.

Recover runs `try`. When it fails, Recover runs the handler for the failure's code, then `try`
again, up to `attempts` times in all. It fails at once when no handler names the code. When a
handler fails, it fails too, and the failure of `try` is the cause. Before `try` runs again, the
keys that it wrote get back their old values. Handle runs `try` once; when it fails, the handler's
result is the node's result.

| `try` returns | Recover                         | Handle                             |
|---------------|---------------------------------|------------------------------------|
| SUCCESS       | SUCCESS                         | SUCCESS                            |
| FAILURE       | handler, then again; or FAILURE | the handler's result; or FAILURE   |
| RUNNING       | RUNNING                         | RUNNING                            |
| SKIPPED       | SKIPPED                         | SKIPPED                            |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from momantu_bt.engine.blackboard import Cell, rollback
from momantu_bt.engine.causes import with_root_cause, with_tries
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FailureValue
from momantu_bt.nodes.counting import count_text, written_count
from momantu_bt.nodes.fallbacks import RoundRobin
from momantu_bt.tree.catalogue.codes import NO_CODES, Codes, Failing
from momantu_bt.tree.catalogue.flow import After, Walk, again, as_child
from momantu_bt.tree.catalogue.known import Key, Known, meet
from momantu_bt.tree.catalogue.spec import Dialect, control, input_port
from momantu_bt.tree.catalogue.wording import tries_text
from momantu_bt.tree.language import ANY, FAILURE_KEY
from momantu_bt.tree.model import Node
from momantu_bt.tree.show.printing import text


@dataclass(frozen=True, slots=True)
class Catch:
    """Failure codes and the handler's node; None means just try again."""

    codes: tuple[str, ...]
    node: TreeNode | None

    def names(self, failure: FailureValue) -> bool:
        """Whether the failure has one of the codes; `grip.TOO_FAR` also needs the node `grip`."""
        for code in self.codes:
            kind, dot, narrowed = code.rpartition(".")
            if code == failure.code:
                return True
            if dot and narrowed == failure.code and _came_from(failure, kind):
                return True
        return False


def _came_from(failure: FailureValue, kind: str) -> bool:
    return any(
        link.code == failure.code and kind in (link.node_type, link.node)
        for link in failure.chain()
    )


def _words(handler: TreeNode) -> str:
    """Describe what a handler will do: the steps of a list, the next child of a round robin."""
    if isinstance(handler, RoundRobin):
        return f"{text(handler.kids[handler.at].model)} ({handler.at + 1} of {len(handler.kids)})"
    if handler.role is Role.STEPS:
        return ", then ".join(text(child.model) for child in handler.kids)
    return text(handler.model)


class Catching(TreeNode):
    """The base of Recover and Handle.

    children: `try`, then the handlers' nodes. caught: the cell that handlers read as `$failure`.
    """

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.catches = tuple(Catch(codes, node) for codes, node in parts.answers)
        assert parts.caught is not None
        self.caught: Cell = parts.caught
        self._answered = [0] * len(self.catches)
        self.handling: Catch | None = None
        self.first: FailureValue | None = None

    @property
    def answered(self) -> tuple[int, ...]:
        """The number of failures that each of `catches` has handled."""
        return tuple(self._answered)

    @property
    def role(self) -> Role:
        """Its role in displays."""
        return Role.RECOVERY

    def clear(self) -> None:
        """Forget the failure that is being handled."""
        self.handling = self.first = None

    @property
    def note(self) -> str:
        """The note while it runs: which failure it handles, and how."""
        if self.handling is None or self.first is None:
            return ""
        handler = self.handling.node
        return f"{self.first.code}: {'again' if handler is None else _words(handler)}"

    def _catch(self, failure: FailureValue) -> Catch | None:
        named = [catch for catch in self.catches if catch.names(failure)]
        rest = [catch for catch in self.catches if ANY in catch.codes]
        return next(iter(named + rest), None)

    def _begin_handling(self, catch: Catch, failure: FailureValue) -> None:
        self.handling, self.first = catch, failure
        self._answered[self.catches.index(catch)] += 1
        self.caught.write(failure)
        self.show(RUNNING)

    def _handler_failed(self, handler: TreeNode) -> FailureValue:
        assert self.first is not None
        return with_root_cause(self.failure_of(handler), self.first)


def _handled(walk: Walk, node: Node, failed: Known) -> list[After]:
    """What is known after each handler; the handler can read `$failure`."""
    return [
        walk(handler.node, failed.having(FAILURE_KEY, Key(FailureValue, handler.place)))
        for handler in node.handlers
        if handler.node is not None
    ]


def _recovered(walk: Walk, node: Node, before: Known) -> After:
    tried = as_child(walk, node, before)
    failures = [end.failure for end in _handled(walk, node, tried.failure)]
    return After(tried.success, meet(tried.failure, *failures), tried.skipped)


def _handled_once(walk: Walk, node: Node, before: Known) -> After:
    tried = as_child(walk, node, before)
    ends = _handled(walk, node, tried.failure)
    return After(
        meet(tried.success, *(end.success for end in ends)),
        meet(tried.failure, *(end.failure for end in ends)),
        meet(tried.skipped, *(end.skipped for end in ends)),
    )


def _left_over(node: Node, failing: Failing) -> Codes:
    """Codes of `try` that no handler names, and codes with which the handlers fail."""
    named = {code for handler in node.handlers for code in handler.codes}
    left = NO_CODES if ANY in named else failing.children - named
    return left | failing.handlers


def _tries(node: Node) -> list[str]:
    return [f"with {tries_text(node, 'attempts')}"] if "attempts" in node.ports else []


class Recover(Catching):
    """Runs `try`; when it fails, runs the handler of its code, then `try` again."""

    spec = control(
        "Recover",
        "recover",
        "Runs `try`; when it fails, runs the handler of its code, then `try` again.",
        input_port("attempts", int, "how often `try` runs at most", least=1),
        dialect=Dialect.OURS,
        children=(1, 1),
        positions=("try",),
        handlers=True,
        tries_again=True,
        retries=True,
        flow=again(_recovered),
        port_words=_tries,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.count = 0
        self.before: dict[Cell, Any] = {}

    def step(self) -> Status:
        """Continue with the handler or with `try`."""
        if self.state is not RUNNING:
            self._start_over()
        self.state = RUNNING
        if self.handling is None:
            status = self._try()
            if status is not RUNNING or self.handling is None:
                return status
        return self._handle()

    @property
    def note(self) -> str:
        """The number of the try, or how it handles the failure before the next try."""
        if self.handling is not None:
            return super().note
        return count_text("try", self.count + 1, written_count(self.model, "attempts"))

    def clear(self) -> None:
        """Forget the tries."""
        super().clear()
        self.count = 0

    def _start_over(self) -> None:
        self.clear()
        self.before = {}
        for node in self.below:
            node.renew()

    def _try(self) -> Status:
        """Tick `try`; when it fails and a handler fits, set `handling` and return RUNNING."""
        body = self.kids[0]
        status = self._noting_writes(body)
        if status is RUNNING:
            return RUNNING
        body.reset()
        if status is not FAILURE:
            self.clear()
            return status
        failure = self.failure_of(body)
        self.count += 1
        attempts: int = self.inputs["attempts"]
        catch = self._catch(failure)
        if catch is None or self.count >= attempts:
            failure = with_tries(self, failure, self.count, attempts)
            self.clear()
            return self.fail_with(failure)
        self._begin_handling(catch, failure)
        return RUNNING

    def _noting_writes(self, body: TreeNode) -> Status:
        """Tick `try`; remember the old values of the keys that it writes."""
        journal = self.context.writes
        seen = len(journal)
        status = body.execute()
        for cell, held in journal[seen:]:
            self.before.setdefault(cell, held)
        return status

    def _handle(self) -> Status:
        assert self.handling is not None
        handler = self.handling.node
        status = SUCCESS if handler is None else handler.execute()
        if status is RUNNING:
            return RUNNING
        if handler is not None:
            handler.reset()
            if status is FAILURE:
                failure = with_tries(
                    self, self._handler_failed(handler), self.count, self.inputs["attempts"]
                )
                self.clear()
                return self.fail_with(failure)
        self.handling = self.first = None
        rollback(self.before.items())
        self.before = {}
        self.show(RUNNING)
        return RUNNING


class Handle(Catching):
    """Runs `try`; when it fails, runs the handler of its code and returns the handler's result."""

    spec = control(
        "Handle",
        "handle",
        "Runs `try`; when it fails, runs the handler of its code and returns its result.",
        dialect=Dialect.OURS,
        children=(1, 1),
        positions=("try",),
        handlers=True,
        flow=_handled_once,
        codes=_left_over,
    )

    def step(self) -> Status:
        """Continue with the handler or with `try`."""
        self.state = RUNNING
        if self.handling is None:
            body = self.kids[0]
            status = body.execute()
            if status is RUNNING:
                return RUNNING
            body.reset()
            if status is not FAILURE:
                return status
            failure = self.failure_of(body)
            catch = self._catch(failure)
            if catch is None:
                return self.fail_with(failure)
            self._begin_handling(catch, failure)
        return self._handle()

    def _handle(self) -> Status:
        assert self.handling is not None
        handler = self.handling.node
        status = SUCCESS if handler is None else handler.execute()
        if status is RUNNING:
            return RUNNING
        failure = (
            None if status is not FAILURE or handler is None else self._handler_failed(handler)
        )
        if handler is not None:
            handler.reset()
        self.clear()
        return status if failure is None else self.fail_with(failure)
