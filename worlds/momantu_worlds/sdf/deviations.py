"""Deviations of an import: what it left out or changed, as a list for the user."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from momantu_bt.formats.places import Place


class Outcome(StrEnum):
    """What became of something: it is gone, or it is there in another form."""

    DROPPED = "dropped"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class Deviation:
    """One thing that did not come over as it was.

    subject: model and link, `kitchen/table/top`. what: the thing, in SDF's words. instead: what
    was done.
    """

    place: Place
    subject: str
    what: str
    instead: str
    outcome: Outcome


@dataclass(slots=True)
class Deviations:
    """The list of an import, in the order of places; one thing is listed once."""

    _all: dict[Deviation, None] = field(default_factory=dict)

    def dropped(self, place: Place, subject: str, what: str, instead: str) -> None:
        """Something is gone."""
        self._all[Deviation(place, subject, what, instead, Outcome.DROPPED)] = None

    def changed(self, place: Place, subject: str, what: str, instead: str) -> None:
        """Something is there in another form."""
        self._all[Deviation(place, subject, what, instead, Outcome.CHANGED)] = None

    def __iter__(self) -> Iterator[Deviation]:
        return iter(sorted(self._all, key=lambda f: (f.place, f.subject, f.what)))

    def __len__(self) -> int:
        return len(self._all)
