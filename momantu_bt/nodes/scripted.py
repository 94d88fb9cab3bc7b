"""TestNode: a leaf that ends as a test demands, in place of a skill."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, SCRIPT_ERROR, Failure
from momantu_bt.nodes.scripts import code_at
from momantu_bt.tree import model
from momantu_bt.tree.catalogue.codes import NO_CODES, Codes, Failing
from momantu_bt.tree.catalogue.flow import After, Walk
from momantu_bt.tree.catalogue.known import NEVER, Known, both, meet
from momantu_bt.tree.catalogue.spec import Scripts, input_port, leaf
from momantu_bt.tree.model import Node
from momantu_bt.values.kinds import CodeText, ScriptText

_SCRIPTS = ("return_status_script", "success_script", "failure_script", "post_script")


_NUMBERS = {"IDLE": 0, "RUNNING": 1, "SUCCESS": 2, "FAILURE": 3, "SKIPPED": 4}
"""Names that `return_status_script` knows, and BehaviorTree.CPP's numbers for them."""


def _prescribed(walk: Walk, node: Node, before: Known) -> After:
    """What is known after the scripts that run at its end; each of them may fail."""
    walk.script(node, "return_status_script", before)
    good = walk.script(node, "success_script", before)
    bad = walk.script(node, "failure_script", before)
    success = both(good, walk.script(node, "post_script", meet(good, bad)))
    status = node.ports.get("return_status", model.Literal("SUCCESS"))
    if "return_status_script" in node.ports or not isinstance(status, model.Literal):
        return After(success, before, before)
    ends = {"SUCCESS": After(success, before), "SKIPPED": After(NEVER, before, before)}
    return ends.get(str(status.value), After(NEVER, before))


def _codes(node: Node, failing: Failing) -> Codes:
    raised = failing.named if "code" in node.ports else NO_CODES
    return raised | {FAILED, SCRIPT_ERROR}


class TestNode(TreeNode):
    """RUNNING for `async_delay`; then it runs its scripts and ends with the prescribed status.

    scripts: those of `return_status_script`, `success_script`, `failure_script` and `post_script`
    that the tree gives. `post_script` runs after `success_script` or `failure_script`.
    """

    spec = leaf(
        "TestNode",
        "test_node",
        "Does what a test prescribes, in place of a skill.",
        input_port(
            "return_status",
            Literal["SUCCESS", "FAILURE", "RUNNING", "SKIPPED"],
            "how it ends; RUNNING is never",
            "SUCCESS",
        ),
        input_port("return_status_script", ScriptText, "gives the status instead", ""),
        input_port("async_delay", float, "how long it runs before its end", 0.0, "s", least=0),
        input_port("code", CodeText, "what it fails with", FAILED),
        input_port("message", str, "the failure's sentence", "the test prescribes a failure"),
        input_port("success_script", ScriptText, "runs at its end with SUCCESS", ""),
        input_port("failure_script", ScriptText, "runs at its end with FAILURE", ""),
        input_port("post_script", ScriptText, "runs at its end, after those two", ""),
        scripts=Scripts.OWN,
        flow=_prescribed,
        codes=_codes,
    )

    __test__ = False  # tell pytest that this is not a test class

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        given = [name for name in _SCRIPTS if name in parts.model.ports]
        self.scripts = {name: code_at(parts, name) for name in given}
        if "return_status_script" in given:
            self.scripts["return_status_script"] = code_at(
                _with_statuses(parts), "return_status_script"
            )
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
        """Restart the delay."""
        self.begun = None

    def _run(self, name: str, due: bool) -> None:
        if due and name in self.scripts:
            self.scripts[name].run()

    def _prescribed(self) -> Status:
        code = self.scripts.get("return_status_script")
        value = self.inputs["return_status"] if code is None else code.run()
        numbers = {number: name for name, number in _NUMBERS.items()}
        name = numbers.get(int(value)) if isinstance(value, int | float) else value
        if not isinstance(name, str) or name not in Status.__members__ or name == IDLE.name:
            raise Failure(
                SCRIPT_ERROR,
                f"return_status_script gives {value!r}, which is not one of "
                "SUCCESS, FAILURE, RUNNING and SKIPPED",
            )
        return Status[name]


def _with_statuses(parts: Parts) -> Parts:
    """The parts with a board on which `SUCCESS` and the others have their numbers."""
    cells = {name: Cell(name, []) for name in _NUMBERS}
    for name, cell in cells.items():
        cell.begin(_NUMBERS[name])
    return replace(parts, board=parts.board.with_cells(cells))
