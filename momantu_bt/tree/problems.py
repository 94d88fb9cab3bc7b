"""What is wrong with a tree file: where, what was expected, and what would have been valid."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from itertools import islice
from typing import Any

from momantu_bt.errors import MomantuError
from momantu_bt.tree.model import Place

NOT_TEXT = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Control characters and the like, which stand in values alone: XML cannot hold them."""
MOST_PROBLEMS = 500
"""Problems of one file that are kept."""
_MOST_COMPARED = 300
"""Known names that a mistyped one is compared with."""
_MOST_LISTED = 60
"""Known names that a hint lists."""


class Severity(IntEnum):
    """An error keeps the tree from starting; a warning and a hint do not."""

    ERROR = 0
    WARNING = 1
    HINT = 2


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong. code: stable, lower-case words joined by dashes.

    message: what is there and what was expected. hint: what would be valid, or what to do.
    """

    code: str
    message: str
    place: Place
    hint: str = ""
    severity: Severity = Severity.ERROR

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "code": self.code,
            "severity": self.severity.name.lower(),
            "file": self.place.file,
            "line": self.place.line,
            "column": self.place.column,
            "length": self.place.length,
            "message": self.message,
            "hint": self.hint,
            "help": f"momantu-bt check --explain {self.code}",
        }


class TreeError(MomantuError):
    """A tree file with errors. problems: all of them, in the order of the file."""

    def __init__(self, problems: Iterable[Problem], source: Mapping[str, str]) -> None:
        self.problems = sort(problems)
        self.source = dict(source)
        super().__init__("\n".join(f"{p.place}: {p.message}" for p in self.problems))

    def printed(self) -> str:
        """Every problem in its line, and how many there are."""
        return report(self.problems, self.source)


class TooManyProblems(TreeError):
    """Nothing is gained by looking on."""


class Problems:
    """A growing list of problems; the same one is kept once.

    The error after the first MOST_PROBLEMS raises TooManyProblems: what else is wrong, and what
    would have been valid, would cost more than anyone reads. Warnings are then left out.
    """

    def __init__(self) -> None:
        self._found: dict[Problem, None] = {}

    def error(self, code: str, place: Place, message: str, hint: str = "") -> None:
        """Add an error."""
        self._add(Problem(code, message, place, hint))

    def warning(self, code: str, place: Place, message: str, hint: str = "") -> None:
        """Add a warning."""
        self._add(Problem(code, message, place, hint, Severity.WARNING))

    def hint(self, code: str, place: Place, message: str, hint: str = "") -> None:
        """Add a hint."""
        self._add(Problem(code, message, place, hint, Severity.HINT))

    def _add(self, problem: Problem) -> None:
        if len(self._found) < MOST_PROBLEMS:
            self._found[problem] = None
        elif problem.severity is Severity.ERROR and problem not in self._found:
            message = f"more than {MOST_PROBLEMS} problems; from here on, nothing is looked at"
            self._found[Problem("too-large", message, problem.place)] = None
            raise TooManyProblems(self._found, {})

    def sorted(self) -> list[Problem]:
        """All of them, in the order of the file."""
        return sort(self._found)


def sort(problems: Iterable[Problem]) -> list[Problem]:
    """By file, line and column; errors first within one place."""
    return sorted(
        problems,
        key=lambda p: (p.place.file, p.place.line, p.place.column, p.severity, p.code, p.message),
    )


def errors(problems: Iterable[Problem]) -> list[Problem]:
    """Those that keep a tree from starting."""
    return [problem for problem in problems if problem.severity is Severity.ERROR]


def nearest(word: str, candidates: Iterable[str]) -> str | None:
    """The known name that a mistyped one most likely means."""
    folded = {name.lower().replace("-", "_"): name for name in candidates}
    exact = folded.get(word.lower().replace("-", "_"))
    if exact is not None:
        return exact
    compared = islice(folded, _MOST_COMPARED)
    close = difflib.get_close_matches(word.lower(), compared, n=1, cutoff=0.6)
    return folded[close[0]] if close else None


def valid_names(word: str, candidates: Iterable[str], what: str) -> str:
    """A hint: the nearest name when there is one, else all of them ("Places: a, b")."""
    names = list(dict.fromkeys(candidates))
    near = nearest(word, names)
    if near is not None:
        return f"did you mean {near}?"
    listed = names[:_MOST_LISTED] + ["…"] * (len(names) > _MOST_LISTED)
    return f"{what}: {', '.join(listed)}" if names else f"there are no {what}"


@lru_cache(maxsize=16)
def lines_of(text: str) -> tuple[str, ...]:
    """A text's lines as YAML counts them; some characters that end lines elsewhere do not here."""
    return tuple(re.split(r"\r\n|\r|\n", text))


_LONGEST_STRETCH = 5000
"""Characters in which a word is looked for; more than a script or a list of codes has."""


def within(place: Place, word: str, source: Mapping[str, str]) -> Place:
    """The stretch of a place's line that holds a word; the place itself where it does not."""
    lines = lines_of(source.get(place.file, ""))
    line = lines[place.line - 1] if 0 < place.line <= len(lines) else ""
    begin = place.column - 1
    stretch = line[begin : begin + max(place.length, _LONGEST_STRETCH)]
    at = stretch.find(word)
    while at >= 0 and re.match(r"\w", stretch[at + len(word) : at + len(word) + 1]):
        at = stretch.find(word, at + 1)
    return place if at < 0 else Place(place.file, place.line, begin + at + 1, len(word))


def show(problem: Problem, source: Mapping[str, str]) -> str:
    """The problem with its line and a caret under the place.

    tree.yaml:3:7: error: no node is called 'pik' [unknown-node]
      3 |     - pik: $can
        |       ^^^ did you mean pick?
    """
    place = problem.place
    word = problem.severity.name.lower()
    head = f"{place}: {word}: {problem.message} [{problem.code}]"
    lines = lines_of(source.get(place.file, ""))
    if not 0 < place.line <= len(lines):
        return head + (f"\n  {problem.hint}" if problem.hint else "")
    text = lines[place.line - 1]
    number = str(place.line)
    shown, column = _window(text, place.column - 1)
    marked = shown[column : column + max(1, place.length)]
    gap = "".join("\t" if c == "\t" else " " * cells(c) for c in shown[:column])
    caret = f"  {' ' * len(number)} | {gap}{'^' * max(1, sum(map(cells, marked)))}"
    shown = "".join(c if c == "\t" or c.isprintable() else "\ufffd" for c in shown)
    return f"{head}\n  {number} | {shown}\n{caret}{' ' + problem.hint if problem.hint else ''}"


MOST_SHOWN = 50
"""Problems printed in full; a terminal holds no more, and the rest often follow from them."""


def report(problems: Sequence[Problem], source: Mapping[str, str]) -> str:
    """Problems as a person reads them: each with its line and a caret, then how many there are."""
    lines = [show(problem, source) for problem in problems[:MOST_SHOWN]]
    if len(problems) > MOST_SHOWN:
        lines.append(f"… and {len(problems) - MOST_SHOWN} more (--json has them all)")
    counts = [
        f"{count} {severity.name.lower()}{'s' if count > 1 else ''}"
        for severity in Severity
        if (count := sum(problem.severity is severity for problem in problems))
    ]
    gravest = min(problems, key=lambda problem: problem.severity)
    more = f"momantu-bt check --explain {gravest.code} says more"
    return "\n".join([*lines, f"{', '.join(counts)}; {more}"])


def cells(character: str) -> int:
    """How many cells of a terminal a character takes."""
    if unicodedata.category(character) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _window(text: str, column: int) -> tuple[str, int]:
    """A stretch of a long line around a column, and the column in it."""
    widest = 120
    if len(text) <= widest:
        return text, column
    start = max(0, column - widest // 2)
    return text[start : start + widest], column - start
