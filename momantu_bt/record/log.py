"""A run as a folder: `changes.jsonl` while it lasts, `report.json` at its end.

Each line of `changes.jsonl` is one change: `{"t": 3.25, "node": 7, "name": "navigate", "place":
"bring_object.yaml:41", "status": "FAILURE", "failure": {…}}`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from momantu_bt.engine.executor import Executor
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

    def ticked(self, run: Executor) -> None:
        """Write this tick's changes."""
        for node, status, note, failure in run.context.changes:
            line: dict[str, Any] = {
                "t": round(run.context.now, 9),
                "node": node.index,
                "name": node.name,
                "place": node.place,
                "status": status.value,
            }
            if note:
                line["note"] = note
            if failure is not None:
                line["failure"] = plain(failure.as_dict())
            self._file.write(json.dumps(line, default=str) + "\n")

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._file.close()
