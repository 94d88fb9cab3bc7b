"""A node's conditions and scripts, run at the moments BehaviorTree.CPP runs them.

`fail_if`, `succeed_if` and `skip_if` are asked only of a node that is not running; `while` on
each tick. `on_success`, `on_failure` and `after` follow an end, `on_halt` a halt.
"""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.script import Script, parse, truth

_BEFORE: Mapping[str, Status] = {"fail_if": FAILURE, "succeed_if": SUCCESS, "skip_if": SKIPPED}
WHILE = "while"
ASKED = (*_BEFORE, WHILE)
"""Conditions; the other scripts only do something."""


class Conditions:
    """The scripts of one node on the board it sees; ScriptError passes through every method.

    counts: of each condition, how often it was asked and how often it held.
    """

    def __init__(self, scripts: Mapping[str, str], board: Board) -> None:
        self._texts = dict(scripts)
        self._parsed: dict[str, Script] = {name: parse(text) for name, text in scripts.items()}
        self._board = board
        self.counts = {name: [0, 0] for name in scripts if name in ASKED}

    def text(self, name: str) -> str:
        """One of the scripts as written."""
        return self._texts.get(name, "")

    def before(self, state: Status) -> Status | None:
        """The status that a condition decides, or None: then the node is ticked."""
        if state is IDLE:
            for name, decided in _BEFORE.items():
                if name in self._parsed and self._holds(name):
                    return decided
        elif state is not RUNNING:
            return None
        if WHILE in self._parsed and not self._holds(WHILE):
            return SKIPPED
        return None

    def _holds(self, name: str) -> bool:
        """Ask one, and count that."""
        held = truth(self._parsed[name].run(self._board))
        counted = self.counts[name]
        counted[0] += 1
        counted[1] += held
        return held

    def after(self, status: Status) -> None:
        """Run the scripts after SUCCESS or FAILURE."""
        self._run("on_success" if status is SUCCESS else "on_failure")
        self._run("after")

    def halted(self) -> None:
        """Run the scripts after a halt."""
        self._run("on_halt")

    def _run(self, name: str) -> None:
        script = self._parsed.get(name)
        if script is not None:
            script.run(self._board)
