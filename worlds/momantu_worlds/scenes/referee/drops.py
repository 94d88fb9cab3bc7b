"""Drops: a held object leaves the hand with nothing close below it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from momantu_bt.geometry import Array, Transform
from momantu_bt.world import TICK, Incident
from momantu_worlds.scenes.geometry.bodies import Body, Episode
from momantu_worlds.scenes.geometry.prisms import body_points, prism_around
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce
from momantu_worlds.scenes.referee.hand import Hand

ABOVE = 0.03
"""Largest height above its support at which a released object counts as placed, not dropped, m."""
GONE = 1.5 * TICK
"""Time without finger contact after which an object has left the hand, s: one tick may be noise."""


@dataclass(slots=True)
class _Grip:
    """touched: time of the last finger contact, s. pose: the object's pose at that time."""

    touched: float
    pose: Transform


class Drops:
    """Watches every loose object from when two fingers hold it and nothing else touches it."""

    def __init__(self, episode: Episode, truth: GroundTruth, hand: Hand) -> None:
        self._truth, self._fingers = truth, hand.fingers
        self._points: dict[str, Array] = {}
        for body in episode.bodies:
            self.added(body)
        self._grips: dict[str, _Grip] = {}
        self.incidents: list[Incident] = []

    def observe(self, now: float, contacts: Iterable[TouchingForce]) -> None:
        """Record the contacts of the tick that ended at `now`, s."""
        gripping: dict[str, int] = {}
        resting: set[str] = set()
        for contact in contacts:
            if contact.first in self._fingers and contact.second in self._points:
                gripping[contact.second] = gripping.get(contact.second, 0) + 1
            elif contact.first not in self._truth.robot_links:
                resting |= {contact.first, contact.second}
        for name, count in gripping.items():
            if name in self._grips or (count > 1 and name not in resting):
                self._grips[name] = _Grip(now, self._truth.pose(name))
        for name, grip in list(self._grips.items()):
            if now - grip.touched > GONE:
                del self._grips[name]
                self._left(name, grip)

    def added(self, body: Body) -> None:
        """A body was added."""
        points = None if body.static else body_points(body)
        if points is not None:
            self._points[body.name] = points

    def removed(self, name: str) -> None:
        """An added body was removed."""
        self._points.pop(name, None)
        self.relocated(name)

    def relocated(self, name: str) -> None:
        """A fault moved an object: the robot did not drop it."""
        self._grips.pop(name, None)

    def _left(self, name: str, grip: _Grip) -> None:
        prism = prism_around(grip.pose.apply(self._points[name]), grip.pose.yaw)
        height, below = self._truth.height_below(name, prism.foot())
        if height > ABOVE:
            sentence = f"{name} left the hand {height:.2f} m above {below}"
            self.incidents.append(Incident(grip.touched, "dropped", sentence, height))
