"""A run as a folder: `changes.jsonl` while it lasts, `report.json` at its end.

Each line of `changes.jsonl` is one change: `{"t": 3.25, "node": 7, "name": "navigate", "place":
"bring_object.yaml:41", "status": "FAILURE", "failure": {…}}`.
"""

from __future__ import annotations

import json
from pathlib import Path

from momantu_bt.engine.executor import Executor
from momantu_bt.engine.node import TreeNode
from momantu_bt.failure import FailureValue
from momantu_bt.messages import plain
from momantu_bt.record.files import OutputError

CHANGES = "changes.jsonl"
REPORT = "report.json"


def prepare_folder(folder: Path) -> None:
    """Make the folder of a record.

    Raises:
        OutputError: it cannot be made, cannot be written, or holds a record already.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / CHANGES).open("x").close()
    except FileExistsError:
        problem = "holds a record already" if folder.is_dir() else "is a file"
        raise OutputError(f"{folder} {problem}; choose another folder") from None
    except OSError as error:
        raise OutputError(f"{folder} cannot be written: {error.strerror or error}") from None


class LogObserver:
    """Writes one line for each change of a node's status."""

    def __init__(self, folder: Path) -> None:
        self._file = (folder / CHANGES).open("w", encoding="utf-8")
        self._nodes: dict[int, str] = {}
        self._failures: dict[int, tuple[FailureValue, str]] = {}

    def ticked(self, run: Executor) -> None:
        """Write this tick's changes."""
        if not run.context.changes:
            return
        time = repr(round(run.context.now, 9))
        lines = []
        for node, status, note, failure in run.context.changes:
            line = f'{{"t": {time}, {self._node(node)}, "status": "{status.value}"'
            if note:
                line += f', "note": {json.dumps(note)}'
            if failure is not None:
                line += f', "failure": {self._failure(node, failure)}'
            lines.append(line + "}\n")
        self._file.write("".join(lines))

    def _node(self, node: TreeNode) -> str:
        """What every line of a node says, written out once."""
        known = self._nodes.get(node.index)
        if known is None:
            name, place = json.dumps(node.name), json.dumps(node.place)
            known = f'"node": {node.index}, "name": {name}, "place": {place}'
            self._nodes[node.index] = known
        return known

    def _failure(self, node: TreeNode, failure: FailureValue) -> str:
        """A failure as JSON; one that comes again is not written out again."""
        known = self._failures.get(node.index)
        if known is None or known[0] is not failure:
            known = (failure, json.dumps(plain(failure.as_dict()), default=str))
            self._failures[node.index] = known
        return known[1]

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._file.close()
