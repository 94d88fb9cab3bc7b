"""Deviations of an import: what it left out or changed, as a list for the user."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from momantu_bt.formats.places import Place

LOST = "this model is left out"
"""What was done about a model of which nothing can be read."""


class Outcome(StrEnum):
    """What happened to an element: it was dropped, or changed."""

    DROPPED = "dropped"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class Deviation:
    """One element that was not imported unchanged.

    subject: model and link, `kitchen/table/top`. what: the element, in SDF's terms. instead: what
    was done.
    """

    place: Place
    subject: str
    what: str
    instead: str
    outcome: Outcome


@dataclass(slots=True)
class Deviations:
    """The deviations of an import, in the order of their places, without duplicates."""

    models_lost: int = 0
    """Models and includes of which nothing was imported."""
    _all: dict[Deviation, None] = field(default_factory=dict)

    def dropped(self, place: Place, subject: str, what: str, instead: str) -> None:
        """Record that something was dropped."""
        self._all[Deviation(place, subject, what, instead, Outcome.DROPPED)] = None

    def lost(self, place: Place, subject: str, why: str) -> None:
        """Record that a whole model was dropped."""
        self.models_lost += 1
        self.dropped(place, subject, why, LOST)

    def changed(self, place: Place, subject: str, what: str, instead: str) -> None:
        """Record that something was changed."""
        self._all[Deviation(place, subject, what, instead, Outcome.CHANGED)] = None

    def __iter__(self) -> Iterator[Deviation]:
        return iter(sorted(self._all, key=lambda f: (f.place, f.subject, f.what)))

    def __len__(self) -> int:
        return len(self._all)
