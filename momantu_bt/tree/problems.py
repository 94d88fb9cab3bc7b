"""The problems of a tree file: a list of limited length, and the exception that carries it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

from momantu_bt.errors import MomantuError
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, Severity, errors, in_order, show

MOST_PROBLEMS = 500
"""Most problems of one file that are kept."""


class TreeError(MomantuError):
    """A tree file with errors. problems: all of them, in the order of the file."""

    def __init__(self, problems: Iterable[Problem], source: Mapping[str, str]) -> None:
        self.problems = in_order(problems)
        self.source = dict(source)
        super().__init__("\n".join(f"{p.place}: {p.message}" for p in self.problems))

    def __str__(self) -> str:
        """Every problem with its line, and the number of problems, as the command line shows it."""
        return report(self.problems, self.source)

    def printed(self) -> str:
        """The same text, without the program's name before it."""
        return str(self)


class TooManyProblems(TreeError):
    """The list of problems is full; the check stops."""


class Problems:
    """A list of problems without duplicates.

    An error after the first `most` problems (None: any number) raises TooManyProblems, as nobody
    reads more; warnings after them are dropped.
    """

    def __init__(self, most: int | None = MOST_PROBLEMS) -> None:
        self._most = most
        self._found: dict[Problem, None] = {}
        self._kept: set[Problem] = set()
        self._keeping = False

    @contextmanager
    def keeping(self) -> Iterator[None]:
        """Within it, errors are about texts that the model keeps.

        They say that the tree cannot run, not that the file cannot be written again.
        """
        before, self._keeping = self._keeping, True
        try:
            yield
        finally:
            self._keeping = before

    def lost(self) -> list[Problem]:
        """The errors after which the model lacks something that the file has."""
        return [each for each in errors(self.sorted()) if each not in self._kept]

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
        if self._keeping and problem not in self._found:
            self._kept.add(problem)
        if self._most is None or len(self._found) < self._most:
            self._found[problem] = None
        elif problem.severity is Severity.ERROR and problem not in self._found:
            message = f"more than {self._most} problems; from here on, nothing is looked at"
            self._found[Problem("too-large", message, problem.place)] = None
            raise TooManyProblems(self._found, {})

    def soften(self, codes: Collection[str]) -> None:
        """Turn the errors with one of these codes into warnings."""
        self._found = {
            replace(each, severity=Severity.WARNING)
            if each.code in codes and each.severity is Severity.ERROR
            else each: None
            for each in self._found
        }

    @property
    def count(self) -> int:
        """The number of problems found so far."""
        return len(self._found)

    @property
    def grave(self) -> bool:
        """Whether there is an error. Advice that may only follow from one is not given then."""
        return any(problem.severity is Severity.ERROR for problem in self._found)

    def sorted(self) -> list[Problem]:
        """All of them, in the order of the file."""
        return in_order(self._found)


MOST_SHOWN = 50
"""Most problems that are printed in full; later ones are often consequences of earlier ones."""


def report(problems: Sequence[Problem], source: Mapping[str, str]) -> str:
    """Problems as text: each with its line and a caret, then the number of problems."""
    lines = [show(problem, source) for problem in problems[:MOST_SHOWN]]
    if len(problems) > MOST_SHOWN:
        lines.append(f"… and {len(problems) - MOST_SHOWN} more (--json has them all)")
    counts = [
        f"{count} {severity.label}{'s' if count > 1 else ''}"
        for severity in Severity
        if (count := sum(problem.severity is severity for problem in problems))
    ]
    gravest = min(problems, key=lambda problem: problem.severity)
    more = f"momantu-bt check --explain {gravest.code} says more"
    return "\n".join([*lines, f"{', '.join(counts)}; {more}"])
