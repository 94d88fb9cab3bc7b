"""What an import could not carry over, and what makes one impossible; each with its place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import islice
from pathlib import Path

from momantu_bt.errors import MomantuError


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """Where something stands. line and column count from 1."""

    file: Path
    line: int = 1
    column: int = 1

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


LONGEST_LINE = 200
"""Characters of a line that a message shows."""
MOST_SHOWN_OF = 32_000_000
"""Bytes of a file of which messages show lines."""


class SdfError(MomantuError):
    """An SDF world cannot be imported; the message says where, why and what to do."""

    def __init__(self, place: Place, message: str) -> None:
        self.place = place
        line = _line_at(place)
        shown = f"\n    {line}\n    {' ' * (place.column - 1)}^" if line.strip() else ""
        super().__init__(f"{place}: {message}{shown}")


def _line_at(place: Place) -> str:
    """The line of the file, for people; empty when it cannot be shown."""
    try:
        if place.file.stat().st_size > MOST_SHOWN_OF:
            return ""
        with place.file.open("rb") as lines:
            found = next(islice(lines, place.line - 1, place.line), b"")
    except OSError:
        return ""
    text = found.decode("utf-8", "replace").rstrip().replace("\t", " ")
    return text if text.isprintable() and place.column <= len(text) <= LONGEST_LINE else ""


class Fate(StrEnum):
    """What became of something: it is gone, or it is there in another form."""

    DROPPED = "dropped"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that did not come over as it was.

    subject: model and link, `kitchen/table/top`. what: the thing, in SDF's words. instead: what
    was done.
    """

    place: Place
    subject: str
    what: str
    instead: str
    fate: Fate


@dataclass(slots=True)
class Findings:
    """The list of an import, in the order of places; one thing is listed once."""

    _all: dict[Finding, None] = field(default_factory=dict)

    def dropped(self, place: Place, subject: str, what: str, instead: str) -> None:
        """Something is gone."""
        self._all[Finding(place, subject, what, instead, Fate.DROPPED)] = None

    def changed(self, place: Place, subject: str, what: str, instead: str) -> None:
        """Something is there in another form."""
        self._all[Finding(place, subject, what, instead, Fate.CHANGED)] = None

    def __iter__(self) -> Iterator[Finding]:
        return iter(sorted(self._all, key=lambda f: (f.place, f.subject, f.what)))

    def __len__(self) -> int:
        return len(self._all)
