"""A node's conditions and scripts, run at the same moments as in BehaviorTree.CPP.

`fail_if`, `succeed_if` and `skip_if` are evaluated when the node starts, `while` on each tick.
`on_success`, `on_failure` and `after` run at the node's end, `on_halt` when it is halted.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.script import Script, parse, truth
from momantu_bt.values.words import in_words

_BEFORE: Mapping[str, Status] = {"fail_if": FAILURE, "succeed_if": SUCCESS, "skip_if": SKIPPED}
WHILE = "while"
ASKED = (*_BEFORE, WHILE)
"""The conditions; the other scripts do not decide anything."""


_LONGEST = 40
"""The most characters of a text among the values of a condition."""


def reason(script: Script, board: Board, *, held: bool = False) -> str:
    """Why a condition has decided: `n > 2` does not hold; n is 1.

    held: whether it was true. Values that take more than a few words are left out.
    """
    words = [f"`{script.text}` {'holds' if held else 'does not hold'}"]
    for name, value in script.values(board):
        if isinstance(value, bool) and script.text.strip("! ") == name:
            continue  # that is said already
        plain = isinstance(value, bool | int | float | str) and not isinstance(value, Enum)
        if plain and len(in_words(value)) <= _LONGEST:
            words.append(f"{name} is {in_words(value) or 'empty'}")
    return "; ".join([words[0], ", ".join(words[1:])] if len(words) > 1 else words)


class Conditions:
    """The scripts of one node and the board that it sees. Each method may raise ScriptError.

    counts: for each condition, how often it was evaluated and how often it was true.
    """

    def __init__(self, scripts: Mapping[str, str], board: Board) -> None:
        self._parsed: dict[str, Script] = {name: parse(text) for name, text in scripts.items()}
        self._board = board
        self.counts = {name: [0, 0] for name in scripts if name in ASKED}

    def reason(self, name: str) -> str:
        """Why a condition that held decided; see `reason`."""
        return reason(self._parsed[name], self._board, held=True)

    def before(self, state: Status) -> Status | None:
        """The status that a condition decides; None: tick the node."""
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
        """Evaluate a condition and count it."""
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
