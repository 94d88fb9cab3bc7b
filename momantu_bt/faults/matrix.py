"""List the rows of a bench of all faults, and say how each must end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase

from momantu_bt.fault import Fault, FaultError
from momantu_bt.fault_kind import FaultKind
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.kinds.reasons import installed_skills, true_reasons
from momantu_bt.faults.spec import format_fault, parse_fault
from momantu_bt.formats.names import valid_names

RECOVERED, ENDED = "recovered", "process ended"


@dataclass(frozen=True, slots=True)
class Row:
    """The requirements on a run with one fault.

    fault: as it is written. recoverable: a robot can still do its work.
    """

    fault: str
    kind: FaultKind
    recoverable: bool

    @property
    def notice(self) -> float:
        """Seconds within which the fault must be noticed, from its beginning."""
        return self.kind.notice

    @property
    def reasons(self) -> frozenset[str]:
        """Failure codes, of the engine and of installed skills, that are a true reason to stop."""
        return true_reasons(self.kind, installed_skills().values())

    @property
    def must_end(self) -> str | frozenset[str]:
        """RECOVERED, ENDED (nothing is left to give a reason), or one of the true reasons."""
        if self.recoverable:
            return RECOVERED
        return ENDED if self.kind.ends_process else self.reasons


def rows() -> tuple[Row, ...]:
    """All rows: each kind with its defaults, and its variants."""
    return tuple(row for kind in kinds().values() for row in _rows_of(kind))


def rows_like(patterns: str, own: Iterable[str] = ()) -> tuple[Row, ...]:
    """The rows for `all`, or for patterns with commas between, such as `camera.*,skill.hang`.

    own: rows of one tree, as they are written; they come last.

    Raises:
        FaultError: a pattern fits no kind of fault.
    """
    wanted = [text.strip() for text in patterns.split(",")]
    having = kinds()
    for pattern in wanted:
        if pattern != "all" and not any(fnmatchcase(name, pattern) for name in having):
            hint = valid_names(pattern, having, "faults")
            if own := [name for name in having if name.startswith(f"{pattern}.")]:
                hint = f"{pattern}.* are {', '.join(own)}"
            raise FaultError(f"no fault is called {pattern!r}; {hint}")
    every = (*rows(), *(row_of(parse_fault(text)) for text in own))
    return tuple(
        row for row in every if any(p == "all" or fnmatchcase(row.kind.name, p) for p in wanted)
    )


def row_of(fault: Fault) -> Row:
    """The row of a fault: that of a variant if the fault has the variant's parameters."""
    kind = kinds()[fault.name]
    for variant in kind.variants:
        given = parse_fault(f"{kind.name}:{variant.parameters}").parameters
        differing = {k: v for k, v in given.items() if v != kind.defaults[k]}
        if all(fault.parameters.get(k) == v for k, v in differing.items()):
            return Row(format_fault(fault), kind, variant.recoverable)
    return Row(format_fault(fault), kind, kind.recoverable)


def _rows_of(kind: FaultKind) -> Iterator[Row]:
    yield Row(kind.name, kind, kind.recoverable)
    for variant in kind.variants:
        yield Row(f"{kind.name}:{variant.parameters}", kind, variant.recoverable)
