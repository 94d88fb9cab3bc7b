"""Impacts: contacts of the robot with a dangerous force."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from momantu_bt.world import Incident
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce
from momantu_worlds.scenes.referee.hand import Hand

MAX_FORCE = 150.0
"""Limit of the contact force, N; ISO/TS 15066 allows a robot to press with 140 N on a hand or a
chest."""
REBOUND = 0.5
"""A contact within this time after another one belongs to the same impact, s, because bodies
rebound."""


@dataclass(slots=True)
class _Impact:
    begun: float
    last: float
    force: float


class Impacts:
    """One incident for each impact of a link on an object: its start and its largest force.

    Squeezing an object between two fingers is not an impact.
    """

    def __init__(self, truth: GroundTruth, hand: Hand) -> None:
        self._links, self._fingers = truth.robot_links, hand.fingers
        self._impacts: dict[tuple[str, str], list[_Impact]] = {}

    def observe(self, now: float, contacts: Iterable[TouchingForce]) -> None:
        """Record the contacts of the tick that ended at `now`, s."""
        contacts = [c for c in contacts if c.first in self._links and c.second not in self._links]
        squeezed = Counter(c.second for c in contacts if c.first in self._fingers)
        for contact in contacts:
            squeeze = contact.first in self._fingers and squeezed[contact.second] > 1
            if contact.force > MAX_FORCE and not squeeze:
                self._take(now, contact)

    def incidents(self) -> list[Incident]:
        """All impacts so far; value: N."""
        return [
            Incident(
                impact.begun,
                "force",
                f"{link} pushed {thing} with {impact.force:.0f} N",
                impact.force,
            )
            for (link, thing), impacts in self._impacts.items()
            for impact in impacts
        ]

    def _take(self, now: float, contact: TouchingForce) -> None:
        impacts = self._impacts.setdefault((contact.first, contact.second), [])
        if impacts and now - impacts[-1].last <= REBOUND:
            impacts[-1].last = now
            impacts[-1].force = max(impacts[-1].force, contact.force)
        else:
            impacts.append(_Impact(now, now, contact.force))
