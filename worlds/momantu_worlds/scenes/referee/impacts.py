"""Impacts: contacts of the robot with a dangerous force."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from momantu_bt.world import Incident
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce
from momantu_worlds.scenes.referee.hand import Hand

HARD = 150.0
"""N; ISO/TS 15066 lets a robot press 140 N on a hand or a chest."""
ONE_BLOW = 0.5
"""s; force that comes back within this time belongs to the same blow: things rebound."""


@dataclass(slots=True)
class _Blow:
    begun: float
    last: float
    force: float


class Blows:
    """One incident for each blow of a link on a thing: since when, and the largest force.

    What two fingers squeeze between them is not a blow.
    """

    def __init__(self, truth: GroundTruth, hand: Hand) -> None:
        self._links, self._fingers = truth.robot_links, hand.fingers
        self._blows: dict[tuple[str, str], list[_Blow]] = {}

    def observe(self, now: float, contacts: Iterable[TouchingForce]) -> None:
        """Take what touched during the tick that ended at `now`, s."""
        contacts = [c for c in contacts if c.first in self._links and c.second not in self._links]
        squeezed = Counter(c.second for c in contacts if c.first in self._fingers)
        for contact in contacts:
            squeeze = contact.first in self._fingers and squeezed[contact.second] > 1
            if contact.force > HARD and not squeeze:
                self._take(now, contact)

    def incidents(self) -> list[Incident]:
        """All blows so far; value: N."""
        return [
            Incident(
                blow.begun, "force", f"{link} pushed {thing} with {blow.force:.0f} N", blow.force
            )
            for (link, thing), blows in self._blows.items()
            for blow in blows
        ]

    def _take(self, now: float, contact: TouchingForce) -> None:
        blows = self._blows.setdefault((contact.first, contact.second), [])
        if blows and now - blows[-1].last <= ONE_BLOW:
            blows[-1].last = now
            blows[-1].force = max(blows[-1].force, contact.force)
        else:
            blows.append(_Blow(now, now, contact.force))
