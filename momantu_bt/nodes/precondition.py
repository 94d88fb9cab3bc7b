"""Precondition: a condition that is asked before the child starts."""

from __future__ import annotations

from typing import Literal

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts
from momantu_bt.engine.status import FAILURE, Status
from momantu_bt.failure import FAILED
from momantu_bt.nodes.scripts import code_at
from momantu_bt.tree.catalogue.flow import perhaps
from momantu_bt.tree.catalogue.spec import decorator, input_port
from momantu_bt.tree.catalogue.wording import script_ports
from momantu_bt.values.kinds import ScriptText


class Precondition(Decorator):
    """Evaluates `if` before the child starts; if it is false, returns the status that `else` names.

    The condition is not evaluated again until the child has ended. As in BehaviorTree.CPP, a halt
    does not count as an end: a child that was halted starts again without a check. Use `fail_if`
    or `skip_if` for a condition that is evaluated at each start.
    """

    spec = decorator(
        "Precondition",
        "precondition",
        "Asks a condition before the child starts.",
        input_port("if", ScriptText, "the condition"),
        input_port(
            "else",
            Literal["FAILURE", "SUCCESS", "RUNNING", "SKIPPED"],
            "the result when it does not hold",
            "FAILURE",
        ),
        modifier=False,
        asks=("if",),
        flow=perhaps,
        port_words=script_ports,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.code = code_at(parts, "if")
        self.admitted = False

    def step(self) -> Status:
        """Evaluate the condition unless the child has started, then tick the child."""
        self.admitted = self.admitted or self.code.holds()
        if not self.admitted:
            instead = Status[self.inputs["else"]]
            if instead is FAILURE:
                return self.fail(FAILED, self.code.reason())
            return instead
        status = self.child.execute()
        if status.completed:
            self.child.reset()
            self.admitted = False
        return self.pass_on(status)

    def renew(self) -> None:
        """Evaluate the condition again at the next start."""
        self.admitted = False
