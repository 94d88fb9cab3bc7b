"""What `momantu-bt check` does with a file, and what must hold of that for any file at all."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from momantu_bt.formats.problems import Problem, show
from momantu_bt.tree.load import load
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry

MOST_SHOWN = 50
"""Problems that `momantu-bt check` prints."""


def check_file(path: Path, registry: Registry) -> int:
    """Read and check a file, and write out what is wrong. A file may be refused.

    Returns: the number of problems.

    Raises:
        Exception: any that reading, checking and writing did not expect. It is a bug.
        AssertionError: a file was refused without a reason, or a place is none.
    """
    try:
        checked = load(str(path), registry)
        problems, source = checked.problems, checked.document.source
    except TreeError as error:
        problems, source = error.problems, error.source
        if not problems:
            raise AssertionError("refused without a reason") from error
    for problem in problems[:MOST_SHOWN]:
        _show(problem, source)
    return len(problems)


def _show(problem: Problem, source: Mapping[str, str]) -> None:
    """Write a problem for a person and for a program, as bytes."""
    show(problem, source).encode("utf-8")
    json.dumps(problem.as_dict(), ensure_ascii=False).encode("utf-8")
    if min(problem.place.line, problem.place.column) < 1:
        raise AssertionError(f"not a place: {problem}")
