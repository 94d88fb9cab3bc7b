"""The referee: whether the goal is met, by ground truth; it changes nothing.

It observes after every tick. Criteria for the end (upright, on the top, beside the marker, still,
touched by nothing else, gripper away) are checked at the last tick. Criteria for the whole run (no
hard bump, no other object pushed or toppled) use the worst tick so far. Dangerous events are
reported in addition, whether or not the goal forbids them: see `incidents`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from momantu_bt.geometry import Transform
from momantu_bt.world import Verdict
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Goal
from momantu_worlds.scenes.geometry.support import SupportTop, UprightCylinder
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce
from momantu_worlds.scenes.referee.hand import Hand
from momantu_worlds.scenes.referee.incidents import Incidents

STILL_SHIFT = 0.002
"""Largest displacement of an object at rest, m: four times the solver's jitter."""
STILL_TURN = math.radians(0.5)
"""Largest rotation of an object at rest, rad."""
ON_TOP = 0.005
"""Tolerance of the height at which an object stands on a top, m."""


@dataclass(slots=True)
class Peak:
    """The largest value so far, and the name of what caused it."""

    value: float = 0.0
    what: str = ""

    def record(self, value: float, what: str) -> None:
        """Record a value; the largest counts."""
        if value > self.value:
            self.value, self.what = value, what


class Referee:
    """Judges one episode; the module's docstring lists the criteria."""

    def __init__(self, episode: Episode, truth: GroundTruth, hand: Hand) -> None:
        """Watch from the next tick on."""
        if episode.goal is None:
            raise ValueError(f"the episode of {episode.name!r} has no goal to judge")
        self._goal: Goal = episode.goal
        self._truth, self._gripper = truth, hand.gripper
        self._item = UprightCylinder(episode.body(self._goal.item))
        self._support = SupportTop(episode.body(self._goal.support))
        self._others = {
            body.name: body.map_from_body
            for body in episode.bodies
            if not body.static and body.name != self._goal.item
        }
        self._shift, self._tilt, self._bump = Peak(), Peak(), Peak()
        self._rest = episode.body(self._goal.item).map_from_body
        self._rest_since = self._now = 0.0
        self._touching: frozenset[str] = frozenset()
        self._incidents = Incidents(episode, truth, hand)
        truth.watch_contacts()

    def observe(self, now: float) -> None:
        """Observe the state at `now`, s; call it once after every tick."""
        self._now = now
        contacts = tuple(self._truth.contacts())
        self._look_at_contacts(contacts)
        self._incidents.observe(now, contacts)
        pose = self._truth.pose(self._goal.item)
        if _moved(self._rest, pose) > STILL_SHIFT or self._rest.angle_to(pose) > STILL_TURN:
            self._rest, self._rest_since = pose, now
        for name, before in self._others.items():
            pose = self._truth.pose(name)
            self._shift.record(_moved(before, pose), name)
            self._tilt.record(tilt(pose), name)

    def relocated(self, name: str) -> None:
        """A fault moved a body, not the robot."""
        self._incidents.relocated(name)

    def added(self, body: Body) -> None:
        """A body was added; a loose one must not be pushed or toppled either."""
        if not body.static:
            self._others[body.name] = body.map_from_body
        self._incidents.added(body)

    def removed(self, name: str) -> None:
        """An added body has left the world."""
        self._others.pop(name, None)
        self._incidents.removed(name)

    def verdict(self) -> Verdict:
        """The verdict on the last observed moment, with every unmet criterion and its numbers."""
        measures = self._measures()
        unmet = tuple(sentence for bad, sentence in self._demands(measures) if bad)
        incidents = self._incidents.until(self._now)
        return Verdict(not unmet, unmet, MappingProxyType(measures), incidents)

    def _look_at_contacts(self, contacts: Iterable[TouchingForce]) -> None:
        links, item = self._truth.robot_links, self._goal.item
        touching = set()
        for contact in contacts:
            pair = (contact.first, contact.second)
            if item in pair:
                touching.add(pair[pair[0] == item])
            elif contact.first in links and contact.second not in links:
                self._bump.record(contact.force, f"{contact.first} on {contact.second}")
        # a body that has fallen asleep reports no contacts: what it last touched still holds
        if touching:
            self._touching = frozenset(touching)

    def _measures(self) -> dict[str, float]:
        goal, truth = self._goal, self._truth
        pose = truth.pose(goal.item)
        support = truth.pose(goal.support)
        away = 0.0
        if goal.marker is not None:
            to_marker = truth.pose(goal.marker).position - pose.position
            away = float(np.hypot(to_marker[0], to_marker[1]))
        return {
            "tilt": tilt(pose),
            "distance": away,
            "margin": self._support.margin(support, pose) - self._item.radius,
            "gap": self._support.height_above(support, pose),
            "still": self._now - self._rest_since,
            "gripper": self._item.distance(pose, truth.link(self._gripper)),
            "others_shift": self._shift.value,
            "others_tilt": self._tilt.value,
            "force": self._bump.value,
        }

    def _demands(self, measures: dict[str, float]) -> list[tuple[bool, str]]:
        """Each criterion: whether it is unmet, and the sentence that says so."""
        goal, m = self._goal, measures
        item, support = goal.item, goal.support
        strangers = ", ".join(sorted(self._touching - {support}))
        return [
            (
                m["tilt"] > goal.max_tilt,
                f"{item} is tilted {_degrees(m['tilt'])}, more than {_degrees(goal.max_tilt)}",
            ),
            (abs(m["gap"]) > ON_TOP, f"{item} is {m['gap']:.3f} m above the top of {support}"),
            (m["margin"] < 0, f"the base of {item} is not whole on the top of {support}"),
            (
                m["distance"] > goal.max_distance,
                f"{item} is {m['distance']:.2f} m from {goal.marker}, more than "
                f"{goal.max_distance:.2f} m",
            ),
            (
                m["still"] < goal.still_for,
                f"{item} has been still for {m['still']:.2f} s, less than {goal.still_for:.2f} s",
            ),
            (support not in self._touching, f"{item} does not touch {support}"),
            (bool(strangers), f"{item} also touches {strangers}"),
            (
                m["gripper"] <= goal.min_gripper_distance,
                f"the gripper is {m['gripper']:.2f} m from {item}, not more than "
                f"{goal.min_gripper_distance:.2f} m",
            ),
            (
                m["others_tilt"] > goal.max_others_tilt,
                f"{self._tilt.what} was tilted by {_degrees(m['others_tilt'])}",
            ),
            (
                m["others_shift"] > goal.max_others_shift,
                f"{self._shift.what} was moved by {m['others_shift']:.2f} m",
            ),
            (
                m["force"] > goal.max_force,
                f"the robot pushed with {m['force']:.0f} N ({self._bump.what}), more than "
                f"{goal.max_force:.0f} N",
            ),
        ]


def tilt(pose: Transform) -> float:
    """Angle between a body's z axis and the vertical, rad."""
    _, x, y, _ = (float(v) for v in pose.quaternion)
    return math.acos(max(-1.0, 1.0 - 2.0 * (x * x + y * y)))


def _moved(before: Transform, now: Transform) -> float:
    x, y, z = (float(v) for v in now.position - before.position)
    return math.sqrt(x * x + y * y + z * z)


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.1f} deg"
