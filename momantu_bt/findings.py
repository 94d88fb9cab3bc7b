"""What a check of a description finds: worlds and robots, each finding at its place in the file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from momantu_bt.bench.seeds import seeds_text

Severity: TypeAlias = Literal["error", "warning"]
"""error: the description cannot be used so. warning: it can, but probably not as it is meant."""

_ORDER: dict[Severity, int] = {"error": 0, "warning": 1}


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that is wrong with what a file describes.

    code: what kind, in lower-case words joined by "-". message: one sentence with the numbers.
    cure: what a person does about it. file, line, column: where, counted from 1; None and 0 where
    no place is to blame. seeds: the episodes in which it is so; empty where seeds do not matter.
    """

    severity: Severity
    code: str
    message: str
    cure: str
    file: Path | None = None
    line: int = 0
    column: int = 0
    seeds: tuple[int, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "severity": self.severity,
            "code": self.code,
            "message": self.message,
            "cure": self.cure,
            "file": None if self.file is None else str(self.file),
            "line": self.line,
            "column": self.column,
            "seeds": list(self.seeds),
        }

    def as_text(self) -> str:
        """`FILE:LINE:COLUMN: severity: message (code)`, and the cure in a line beneath it."""
        place = "" if self.file is None else f"{self.file}:{self.line}:{self.column}: "
        many = "s" if len(self.seeds) > 1 else ""
        seeds = f" [seed{many} {seeds_text(self.seeds)}]" if self.seeds else ""
        return f"{place}{self.severity}: {self.message} ({self.code}){seeds}\n    {self.cure}"


def in_order(findings: Iterable[Finding]) -> list[Finding]:
    """Errors first, then by place, code and words."""
    return sorted(
        findings,
        key=lambda f: (_ORDER[f.severity], str(f.file or ""), f.line, f.column, f.code, f.message),
    )


def findings_text(subject: str, findings: Sequence[Finding]) -> str:
    """What a terminal shows: every finding and one line that counts them."""
    errors = sum(finding.severity == "error" for finding in findings)
    warnings = len(findings) - errors
    if not findings:
        return f"{subject}: nothing is wrong"
    counted = [_count(errors, "error"), _count(warnings, "warning")]
    lines = [finding.as_text() for finding in in_order(findings)]
    return "\n".join([*lines, f"{subject}: {' and '.join(c for c in counted if c)}"])


def findings_json(subject: str, findings: Sequence[Finding]) -> dict[str, Any]:
    """What a program reads."""
    return {
        "subject": subject,
        "ok": not findings,
        "findings": [finding.as_dict() for finding in in_order(findings)],
    }


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' if number > 1 else ''}" if number else ""
