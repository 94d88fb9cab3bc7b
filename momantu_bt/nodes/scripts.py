"""Script and ScriptCondition: the leaves that read and write the blackboard by a script."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.conditions import reason
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED, SCRIPT_ERROR, Failure
from momantu_bt.tree import script
from momantu_bt.tree.catalogue.spec import Scripts, input_port, leaf
from momantu_bt.tree.catalogue.wording import script_ports
from momantu_bt.tree.script import ScriptSyntaxError, parse, truth
from momantu_bt.values.kinds import ScriptText

_parsed: Callable[[str], script.Script] = lru_cache(maxsize=256)(parse)


class Code:
    """A script and the board that it reads and writes.

    read: returns the script's text, a constant or the value of a key.
    """

    def __init__(self, read: Callable[[], str], board: Board) -> None:
        self._read = read
        self._board = board

    @property
    def text(self) -> str:
        """The script as written."""
        return self._read()

    def run(self) -> object:
        """Run the script and return its value; ScriptError or Failure SCRIPT_ERROR if it fails."""
        try:
            parsed = _parsed(self._read())
        except ScriptSyntaxError as error:
            raise Failure(SCRIPT_ERROR, f"`{self.text}`: {error}") from None
        return parsed.run(self._board)

    def reason(self) -> str:
        """Why the condition does not hold, with the values that it compares."""
        return reason(_parsed(self._read()), self._board)

    def holds(self) -> bool:
        """Run the script as a condition; return whether it is true."""
        return truth(self.run())


def code_at(parts: Parts, port: str) -> Code:
    """The script at a port, on the board that its node sees."""
    return Code(parts.inputs().readers[port], parts.board)


class Script(TreeNode):
    """Runs a script and succeeds; fails with SCRIPT_ERROR when it cannot be evaluated."""

    spec = leaf(
        "Script",
        "script",
        "Runs a script.",
        input_port("code", ScriptText, "the script"),
        scripts=Scripts.RUN,
        port_words=script_ports,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.code = code_at(parts, "code")

    def step(self) -> Status:
        """Run the script."""
        self.code.run()
        return SUCCESS


class ScriptCondition(Script):
    """SUCCESS when the condition holds, else FAILURE with FAILED."""

    spec = leaf(
        "ScriptCondition",
        "condition",
        "Succeeds when a condition holds, fails when it does not.",
        input_port("code", ScriptText, "the condition"),
        asks=("code",),
        condition=True,
        port_words=script_ports,
    )

    def step(self) -> Status:
        """Evaluate the condition."""
        if self.code.holds():
            return SUCCESS
        return self.fail(FAILED, self.code.reason())
