"""Script and ScriptCondition: the leaves that read and write the blackboard by a script."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED, SCRIPT_ERROR, Failure
from momantu_bt.tree.script import Script, ScriptSyntaxError, parse, truth

_parsed: Callable[[str], Script] = lru_cache(maxsize=256)(parse)


class Code:
    """A script on a board. `read` gives its text: usually a constant, possibly a wire's value."""

    def __init__(self, read: Callable[[], str], board: Board) -> None:
        self._read = read
        self._board = board

    @property
    def text(self) -> str:
        """The script as written."""
        return self._read()

    def run(self) -> object:
        """Run it; ScriptError or Failure SCRIPT_ERROR when that cannot be done."""
        try:
            script = _parsed(self._read())
        except ScriptSyntaxError as error:
            raise Failure(SCRIPT_ERROR, f"`{self.text}`: {error}") from None
        return script.run(self._board)

    def holds(self) -> bool:
        """Run it as a condition."""
        return truth(self.run())


class ScriptNode(TreeNode):
    """Runs a script and succeeds; fails with SCRIPT_ERROR when it cannot be evaluated."""

    def __init__(self, *arguments: Any, code: Code, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.code = code

    def step(self) -> Status:
        """Run it."""
        self.code.run()
        return SUCCESS


class ScriptCondition(ScriptNode):
    """SUCCESS when the condition holds, else FAILURE with FAILED."""

    def step(self) -> Status:
        """Ask it."""
        if self.code.holds():
            return SUCCESS
        return self.fail(FAILED, f"`{self.code.text}` does not hold")
