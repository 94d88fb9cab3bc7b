"""One demand: an item stands or lies on its support, beside its marker, still, and let go of."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Goal
from momantu_worlds.scenes.geometry.solids import PlacedBody
from momantu_worlds.scenes.geometry.support import SupportTop, UprightCylinder
from momantu_worlds.scenes.referee.ground_truth import GroundTruth

STILL_SHIFT = 0.002
"""Largest displacement of an object at rest, m: four times the solver's jitter."""
STILL_TURN = math.radians(0.5)
"""Largest rotation of an object at rest, rad."""
STANDING = math.radians(0.1)
"""Largest tilt of a body that stood at the start, rad."""
ON_TOP = 0.005
"""Tolerance of the height at which an object stands on a top, m."""


class ItemDemand:
    """Watches one item, and judges it at the last tick."""

    def __init__(self, episode: Episode, goal: Goal, truth: GroundTruth) -> None:
        self.goal, self._truth = goal, truth
        self._body: Body = episode.body(goal.item)
        self._item = UprightCylinder(self._body)
        self._support = SupportTop(episode.body(goal.support))
        self._rest = episode.body(goal.item).map_from_body
        self._rest_since = 0.0
        self._pose: Transform | None = None
        self._touching: frozenset[str] = frozenset()

    def observe(self, now: float, touching: frozenset[str]) -> None:
        """Observe the item at `now`, s. touching: what it touched during the tick."""
        # a body that has fallen asleep reports no contacts: what it last touched still holds
        if touching:
            self._touching = touching
        pose = self._truth.pose(self.goal.item)
        if pose is self._pose:  # it has not moved since
            return
        self._pose = pose
        if moved(self._rest, pose) > STILL_SHIFT or self._rest.angle_to(pose) > STILL_TURN:
            self._rest, self._rest_since = pose, now

    def measures(self, now: float, gripper: str | None) -> dict[str, float]:
        """The numbers that are judged at `now`, s. gripper: its link; None without a hand."""
        goal, truth = self.goal, self._truth
        placed = PlacedBody(self._body, truth.pose(goal.item))
        foot = self._body.foot_at(placed.pose)
        support = truth.pose(goal.support)
        middle = placed.centre if goal.lying else foot.position
        away = 0.0
        if goal.marker is not None:
            to_marker = truth.pose(goal.marker).position - middle
            away = float(np.hypot(to_marker[0], to_marker[1]))
        margin, gap = self._resting(placed, foot, support)
        return {
            "tilt": abs(math.pi / 2 - tilt(foot)) if goal.lying else tilt(foot),
            "distance": away,
            "margin": margin,
            "gap": gap,
            "still": now - self._rest_since,
            "gripper": (
                math.inf if gripper is None else self._item.distance(foot, truth.link(gripper))
            ),
        }

    def _resting(
        self, placed: PlacedBody, foot: Transform, support: Transform
    ) -> tuple[float, float]:
        """How far the item is within the nearest edge, and how far it is above the top, m.

        One that is to stand is judged by the circle and the height of its foot, one that is to lie
        by all of its points. foot, support: poses of its foot and of the supporting body.
        """
        if not self.goal.lying:
            within = self._support.margin(support, foot) - self._item.radius
            return within, self._support.height_above(support, foot)
        points = [Transform(p) for solid in placed.solids for p in solid.vertices]
        within = min(self._support.margin(support, point) for point in points)
        return within, min(self._support.height_above(support, point) for point in points)

    def unmet(self, m: dict[str, float]) -> tuple[str, ...]:
        """A sentence for each criterion that these measures do not meet."""
        goal = self.goal
        item, support = goal.item, goal.support
        strangers = ", ".join(sorted(self._touching - {support}))
        criteria = (
            (
                m["tilt"] > goal.max_tilt,
                f"{item} is tilted {degrees(m['tilt'])}{' from level' if goal.lying else ''}, "
                f"more than {degrees(goal.max_tilt)}",
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
        )
        return tuple(sentence for bad, sentence in criteria if bad)


def tilt(pose: Transform) -> float:
    """Angle between a body's z axis and the vertical, rad."""
    _, x, y, _ = pose.quaternion.tolist()
    return math.acos(max(-1.0, 1.0 - 2.0 * (x * x + y * y)))


def leaned(before: Transform, now: Transform) -> float:
    """How far a body's z axis has turned, rad; of one that stood, its tilt."""
    return tilt(now) if tilt(before) < STANDING else tilt(before.inverse() @ now)


def moved(before: Transform, now: Transform) -> float:
    """Distance between two positions, m."""
    x, y, z = (now.position - before.position).tolist()
    return math.sqrt(x * x + y * y + z * z)


def degrees(angle: float) -> str:
    """An angle in rad, as a person reads it."""
    return f"{math.degrees(angle):.1f} deg"
