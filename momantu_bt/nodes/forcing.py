"""Inverter, ForceSuccess, ForceFailure, ElseFail: decorators that change the child's result.

| child returns   | Inverter | ForceSuccess | ForceFailure | ElseFail                |
|-----------------|----------|--------------|--------------|-------------------------|
| SUCCESS         | FAILURE  | SUCCESS      | FAILURE      | SUCCESS                 |
| FAILURE         | SUCCESS  | SUCCESS      | FAILURE      | FAILURE with its `code` |
| RUNNING SKIPPED | the same | the same     | the same     | the same                |
"""

from __future__ import annotations

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.tree.catalogue.codes import NO_CODES
from momantu_bt.tree.catalogue.flow import After, Walk, as_child
from momantu_bt.tree.catalogue.known import NEVER, Known, meet
from momantu_bt.tree.catalogue.spec import Dialect, decorator, input_port
from momantu_bt.tree.catalogue.wording import port_text
from momantu_bt.tree.model import Node
from momantu_bt.values.kinds import CodeText


def _inverted(walk: Walk, node: Node, before: Known) -> After:
    end = as_child(walk, node, before)
    return After(end.failure, end.success, end.skipped)


def _succeeding(walk: Walk, node: Node, before: Known) -> After:
    end = as_child(walk, node, before)
    return After(meet(end.success, end.failure), NEVER, end.skipped)


def _failing(walk: Walk, node: Node, before: Known) -> After:
    end = as_child(walk, node, before)
    return After(NEVER, meet(end.success, end.failure), end.skipped)


class _Changing(Decorator):
    """Ticks the child; when it ends, returns the status from `end`."""

    def step(self) -> Status:
        """Tick the child."""
        self.state = RUNNING
        status = self.child.execute()
        if not status.completed:
            return status
        self.child.reset()
        return self.end(status)

    def end(self, status: Status) -> Status:
        """The node's status after the child's SUCCESS or FAILURE."""
        raise NotImplementedError


class Inverter(_Changing):
    """Turns SUCCESS into FAILURE and FAILURE into SUCCESS."""

    spec = decorator(
        "Inverter",
        "invert",
        "Success becomes failure and failure success.",
        flow=_inverted,
        around=lambda node: "inverted",
    )

    def end(self, status: Status) -> Status:
        """The opposite status."""
        if status is FAILURE:
            return SUCCESS
        return self.fail(FAILED, f"{self.child.name} succeeded, which counts as failure here")


class ForceSuccess(_Changing):
    """Succeeds when the child ends, also when it fails."""

    spec = decorator(
        "ForceSuccess",
        "force_success",
        "Whatever the child's end: success.",
        flow=_succeeding,
        codes=lambda node, failing: NO_CODES,
        around=lambda node: "success in any case",
    )

    def end(self, status: Status) -> Status:
        """SUCCESS."""
        return SUCCESS


class ForceFailure(_Changing):
    """Fails when the child ends, with the child's failure if it failed."""

    spec = decorator(
        "ForceFailure",
        "force_failure",
        "Whatever the child's end: failure.",
        flow=_failing,
        around=lambda node: "failure in any case",
    )

    def end(self, status: Status) -> Status:
        """FAILURE."""
        if status is FAILURE:
            return self.pass_on(FAILURE)
        return self.fail(FAILED, f"{self.child.name} succeeded, and the tree forces a failure")


class ElseFail(_Changing):
    """When the child fails, fails with the code that the tree gives; the cause is the child's."""

    spec = decorator(
        "ElseFail",
        "else_fail",
        "When the child fails, fails with a code of your own; the child's failure is its cause.",
        input_port("code", CodeText, "upper-case words joined by underscores"),
        input_port("message", str, "one sentence for a person", ""),
        dialect=Dialect.OURS,
        flow=as_child,
        codes=lambda node, failing: failing.named if failing.children else NO_CODES,
        around=lambda node: f"else {port_text(node, 'code')}",
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()

    def end(self, status: Status) -> Status:
        """Fail with the code when the child failed; SUCCESS stays."""
        if status is not FAILURE:
            return status
        cause = self.failure_of(self.child)
        return self.fail(str(self.inputs["code"]), self.inputs["message"], cause)
