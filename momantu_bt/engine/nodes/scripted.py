"""TestNode: a leaf that does what a test prescribes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.nodes.scripts import Code
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.session import CLOCK_SLACK
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import SCRIPT_ERROR, Failure


class TestNode(TreeNode):
    """RUNNING for `async_delay`, then its scripts run and it ends as prescribed.

    scripts: `return_status_script`, `success_script`, `failure_script` and `post_script`, those
    that are given; `post_script` runs after either of the two before it.
    """

    __test__ = False  # pytest would take it for a class of tests

    def __init__(
        self, *arguments: Any, inputs: Inputs, scripts: Mapping[str, Code], **named: Any
    ) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs
        self.scripts = dict(scripts)
        self.begun: float | None = None

    def step(self) -> Status:
        """Wait, then end."""
        if self.begun is None:
            self.begun = self.context.now
        delay: float = self.inputs["async_delay"]
        if self.context.now - self.begun < delay - CLOCK_SLACK:
            return RUNNING
        status = self._prescribed()
        if status is RUNNING:
            return RUNNING
        self.begun = None
        self._run("success_script", status is SUCCESS)
        self._run("failure_script", status is FAILURE)
        self._run("post_script", True)
        if status is FAILURE:
            return self.fail(str(self.inputs["code"]), self.inputs["message"])
        return status

    def clear(self) -> None:
        """The time starts anew."""
        self.begun = None

    def _run(self, name: str, due: bool) -> None:
        if due and name in self.scripts:
            self.scripts[name].run()

    def _prescribed(self) -> Status:
        code = self.scripts.get("return_status_script")
        name = self.inputs["return_status"] if code is None else code.run()
        if not isinstance(name, str) or name not in Status.__members__ or name == IDLE.name:
            raise Failure(
                SCRIPT_ERROR,
                f"return_status_script gives {name!r}, which is not one of "
                "'SUCCESS', 'FAILURE', 'RUNNING' and 'SKIPPED'",
            )
        return Status[name]
