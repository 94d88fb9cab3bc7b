"""A problem of a file: where, what was expected, and what would have been valid."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from momantu_bt.formats.places import NOWHERE, Place, excerpt


class Severity(IntEnum):
    """With an error a file cannot be used; with a warning or a hint it can."""

    ERROR = 0
    WARNING = 1
    HINT = 2

    @property
    def label(self) -> str:
        """The word that a person and a program read: "error", "warning", "hint"."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong.

    code: stable, lower-case words joined by dashes; empty where problems of a file have no codes.
    message: what is there and what was expected. hint: what would be valid, or what to do.
    """

    code: str
    message: str
    place: Place = NOWHERE
    hint: str = ""
    severity: Severity = Severity.ERROR

    def __str__(self) -> str:
        """On one line, without the hint: `t.yaml:3:7: error: no node is called 'pik' [code]`."""
        place = f"{self.place}: " if self.place != NOWHERE else ""
        code = f" [{self.code}]" if self.code else ""
        return f"{place}{self.severity.label}: {self.message}{code}"

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
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
    """By file, line and column; errors first within one place."""
    return sorted(
        problems,
        key=lambda p: (p.place.file, p.place.line, p.place.column, p.severity, p.code, p.message),
    )


def errors(problems: Iterable[Problem]) -> list[Problem]:
    """Those with which the file cannot be used."""
    return [problem for problem in problems if problem.severity is Severity.ERROR]


def show(problem: Problem, source: Mapping[str, str]) -> str:
    """The problem with its line and a caret under the place. source: texts by names of files.

    tree.yaml:3:7: error: no node is called 'pik' [unknown-node]
      3 |     - pik: $can
        |       ^^^ did you mean pick?
    """
    below = excerpt(problem.place, source.get(problem.place.file, ""), problem.hint)
    return f"{problem}\n{below}" if below else str(problem)
