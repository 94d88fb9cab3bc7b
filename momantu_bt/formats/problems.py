"""A problem of a file: where, what was expected, and what would have been valid."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from momantu_bt.formats.places import NOWHERE, Place, excerpt


class Severity(IntEnum):
    """How serious a problem is. A file with an error cannot be used; the others allow its use."""

    ERROR = 0
    WARNING = 1
    HINT = 2

    @property
    def label(self) -> str:
        """The word in messages and in JSON: "error", "warning" or "hint"."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong in a file.

    code: a stable name, lower-case words joined by dashes; empty for files without such codes.
    message: what was found and what was expected. hint: what would be valid, or what to do.
    """

    code: str
    message: str
    place: Place = NOWHERE
    hint: str = ""
    severity: Severity = Severity.ERROR

    def __str__(self) -> str:
        """One line without the hint: `t.yaml:3:7: error: no node is called 'pik' [code]`."""
        place = f"{self.place}: " if self.place != NOWHERE else ""
        code = f" [{self.code}]" if self.code else ""
        return f"{place}{self.severity.label}: {self.message}{code}"

    def as_dict(self) -> dict[str, Any]:
        """The problem as plain data for JSON."""
        return {
            "code": self.code,
            "severity": self.severity.label,
            "file": self.place.file,
            "line": self.place.line,
            "column": self.place.column,
            "length": self.place.length,
            "message": self.message,
            "hint": self.hint,
        }


def in_order(problems: Iterable[Problem]) -> list[Problem]:
    """Sort by file, line and column; at the same place, errors come first."""
    return sorted(
        problems,
        key=lambda p: (p.place.file, p.place.line, p.place.column, p.severity, p.code, p.message),
    )


def errors(problems: Iterable[Problem]) -> list[Problem]:
    """The errors among some problems; with one of them, the file cannot be used."""
    return [problem for problem in problems if problem.severity is Severity.ERROR]


def show(problem: Problem, source: Mapping[str, str]) -> str:
    """The problem with its line and a caret under the place. source: the files' texts by name.

    tree.yaml:3:7: error: no node is called 'pik' [unknown-node]
      3 |     - pik: $can
        |       ^^^ did you mean pick?
    """
    below = excerpt(problem.place, source.get(problem.place.file, ""), problem.hint)
    return f"{problem}\n{below}" if below else str(problem)
