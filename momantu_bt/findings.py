"""Findings of the checks of world files and robot files, each at its place in the file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from momantu_bt.formats.places import NOWHERE, KeyPath, Place
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.formats.seeds import seeds_text


@dataclass(frozen=True, slots=True)
class Finding(Problem):
    """A problem of what a file describes, rather than of how it is written.

    seeds: the episodes with this problem; empty if seeds do not matter.
    """

    seeds: tuple[int, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "severity": self.severity.label,
            "code": self.code,
            "message": self.message,
            "cure": self.hint,
            "file": self.place.file or None,
            "line": self.place.line,
            "column": self.place.column,
            "seeds": list(self.seeds),
        }

    def as_text(self) -> str:
        """`FILE:LINE:COLUMN: severity: message (code)`, and the hint in a line beneath it."""
        place = "" if self.place == NOWHERE else f"{self.place}: "
        many = "s" if len(self.seeds) > 1 else ""
        seeds = f" [seed{many} {seeds_text(self.seeds)}]" if self.seeds else ""
        return f"{place}{self.severity.label}: {self.message} ({self.code}){seeds}\n    {self.hint}"


@dataclass(frozen=True, slots=True)
class FindingAtKeys:
    """A finding before its line is known: the keys of a description file lead to what is wrong.

    Within one episode, two findings differ in code, keys or about. If several episodes have the
    same finding, it counts once, in the words of the episode with the greatest `amount`.
    """

    severity: Severity
    code: str
    message: str
    hint: str
    keys: KeyPath
    about: tuple[str, ...] = ()
    amount: float = 0.0

    def at(self, place: Place, seeds: Iterable[int] = ()) -> Finding:
        """The finding at its place. seeds: the episodes with this problem."""
        return Finding(self.code, self.message, place, self.hint, self.severity, tuple(seeds))


def worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Errors first, then by place, code and words."""
    return sorted(findings, key=lambda f: (f.severity, f.place, f.code, f.message))


def findings_text(subject: str, findings: Sequence[Finding]) -> str:
    """The text for a terminal: every finding, and one line that counts them."""
    errors = sum(finding.severity is Severity.ERROR for finding in findings)
    warnings = len(findings) - errors
    if not findings:
        return f"{subject}: nothing is wrong"
    counted = [_count(errors, "error"), _count(warnings, "warning")]
    lines = [finding.as_text() for finding in worst_first(findings)]
    return "\n".join([*lines, f"{subject}: {' and '.join(c for c in counted if c)}"])


def findings_json(subject: str, findings: Sequence[Finding]) -> dict[str, Any]:
    """The data for a program."""
    return {
        "subject": subject,
        "ok": not findings,
        "findings": [finding.as_dict() for finding in worst_first(findings)],
    }


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' if number > 1 else ''}" if number else ""
