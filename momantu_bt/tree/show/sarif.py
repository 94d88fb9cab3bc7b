"""Problems as SARIF 2.1.0, which editors and code reviews show beside the lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.tree.show.problem_pages import codes, explanation
from momantu_bt.version import __version__

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.HINT: "note"}


def sarif(problems: Sequence[Problem], unread: Sequence[str] = ()) -> dict[str, Any]:
    """One run of the checker as a SARIF log; columns count characters.

    unread: sentences about files that could not be opened. The log lists the rules that the
    results name, in alphabetical order.
    """
    used = sorted({problem.code for problem in problems})
    index = {code: number for number, code in enumerate(used)}
    driver = {
        "name": "momantu-bt check",
        "version": __version__,
        "rules": [_rule(code) for code in used],
    }
    return {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {"driver": driver},
                "invocations": [_invocation(unread)],
                "columnKind": "unicodeCodePoints",
                "results": [_result(problem, index[problem.code]) for problem in problems],
            }
        ],
    }


def _invocation(unread: Sequence[str]) -> dict[str, Any]:
    notifications = [{"level": "error", "message": {"text": sentence}} for sentence in unread]
    return {"executionSuccessful": not unread, "toolExecutionNotifications": notifications}


def _rule(code: str) -> dict[str, Any]:
    return {
        "id": code,
        "shortDescription": {"text": codes()[code]},
        "help": {"text": codes()[code], "markdown": explanation(code)},
    }


def _result(problem: Problem, rule: int) -> dict[str, Any]:
    hint = f" ({problem.hint})" if problem.hint else ""
    place = problem.place
    region = {
        "startLine": place.line,
        "startColumn": place.column,
        "endColumn": place.column + place.length,
    }
    return {
        "ruleId": problem.code,
        "ruleIndex": rule,
        "level": _LEVELS[problem.severity],
        "message": {"text": problem.message + hint},
        "locations": [
            {
                "physicalLocation": {
                    "artifactLocation": {"uri": _uri(place.file)},
                    "region": region,
                }
            }
        ],
    }


def _uri(file: str) -> str:
    """A relative path unchanged, or an absolute path as a file URI."""
    path = Path(file)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())
