"""The referee: judges an episode from ground truth alone, and touches nothing.

It looks after every tick. What must hold at the end (upright, on the top, beside the marker,
still, touched by nothing else, gripper away) is judged of the last tick; what must never happen
(a hard bump, another thing pushed or toppled) of the worst tick so far.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import numpy as np

from momantu_bt.geometry import Transform
from momantu_bt.world import Verdict
from momantu_worlds.scenes.bodies import Body, Box, Cylinder, Episode, Goal

STILL_SHIFT = 0.002
"""m; what stands still stays within this of where it was: four times what the solver jitters."""
STILL_TURN = math.radians(0.5)
"""rad; likewise."""
ON_TOP = 0.005
"""m; the base may be this far above or below the top and still count as standing on it."""


class TouchingForce(Protocol):
    """Two things that touched; the robot's links come first. force: N, averaged over the tick."""

    @property
    def first(self) -> str:
        """Name of a robot's link, or of a body."""
        ...

    @property
    def second(self) -> str:
        """Name of a body or of a link."""
        ...

    @property
    def force(self) -> float:
        """N."""
        ...


class GroundTruth(Protocol):
    """What a simulator tells a referee."""

    @property
    def robot_links(self) -> frozenset[str]:
        """Names of the robot's links."""
        ...

    def pose(self, body: str, /) -> Transform:
        """`map_from_body`."""
        ...

    def link(self, name: str, /) -> Transform:
        """`map_from_link`."""
        ...

    def watch_contacts(self) -> None:
        """Collect contacts from the next tick on."""
        ...

    def contacts(self) -> Iterable[TouchingForce]:
        """What touched during the last tick."""
        ...


@dataclass(slots=True)
class Worst:
    """The largest value so far, and of what."""

    value: float = 0.0
    what: str = ""

    def see(self, value: float, what: str) -> None:
        """Keep the value if it is larger."""
        if value > self.value:
            self.value, self.what = value, what


class Referee:
    """Judges one episode; see the module's text for what it holds against whom."""

    def __init__(self, episode: Episode, truth: GroundTruth, gripper: str) -> None:
        """gripper: the robot's link whose origin lies between the gripper's pads."""
        if episode.goal is None:
            raise ValueError(f"the episode of {episode.name!r} has no goal to judge")
        self._goal: Goal = episode.goal
        self._truth, self._gripper = truth, gripper
        self._item = _Upright(episode.body(self._goal.item))
        self._support = _Top(episode.body(self._goal.support))
        self._others = {
            body.name: body.map_from_body
            for body in episode.bodies
            if not body.static and body.name != self._goal.item
        }
        self._shift, self._tilt, self._bump = Worst(), Worst(), Worst()
        self._rest = episode.body(self._goal.item).map_from_body
        self._rest_since = self._now = 0.0
        self._touching: frozenset[str] = frozenset()
        truth.watch_contacts()

    def observe(self, now: float) -> None:
        """Look at the instant `now`, s; to be called once after every tick."""
        self._now = now
        self._look_at_contacts()
        pose = self._truth.pose(self._goal.item)
        if _moved(self._rest, pose) > STILL_SHIFT or self._rest.angle_to(pose) > STILL_TURN:
            self._rest, self._rest_since = pose, now
        for name, before in self._others.items():
            pose = self._truth.pose(name)
            self._shift.see(_moved(before, pose), name)
            self._tilt.see(tilt(pose), name)

    def verdict(self) -> Verdict:
        """The word on the instant last observed, with every unmet demand and the numbers."""
        measures = self._measures()
        unmet = tuple(sentence for bad, sentence in self._demands(measures) if bad)
        return Verdict(not unmet, unmet, MappingProxyType(measures))

    def _look_at_contacts(self) -> None:
        links, item = self._truth.robot_links, self._goal.item
        touching = set()
        for contact in self._truth.contacts():
            pair = (contact.first, contact.second)
            if item in pair:
                touching.add(pair[pair[0] == item])
            elif contact.first in links and contact.second not in links:
                self._bump.see(contact.force, f"{contact.first} on {contact.second}")
        # a body that has fallen asleep reports no contacts: what it last touched still holds
        if touching:
            self._touching = frozenset(touching)

    def _measures(self) -> dict[str, float]:
        goal, truth = self._goal, self._truth
        pose = truth.pose(goal.item)
        support = truth.pose(goal.support)
        to_marker = truth.pose(goal.marker).position - pose.position
        return {
            "tilt": tilt(pose),
            "distance": float(np.hypot(to_marker[0], to_marker[1])),
            "margin": self._support.margin(support, pose) - self._item.radius,
            "gap": self._support.height_above(support, pose),
            "still": self._now - self._rest_since,
            "gripper": self._item.distance(pose, truth.link(self._gripper)),
            "others_shift": self._shift.value,
            "others_tilt": self._tilt.value,
            "force": self._bump.value,
        }

    def _demands(self, measures: dict[str, float]) -> list[tuple[bool, str]]:
        """Each demand: whether it is unmet, and the sentence that says so."""
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


class _Upright:
    """The cylinder that an item is, standing on its origin."""

    def __init__(self, body: Body) -> None:
        shape = next(
            (p.geometry for p in body.parts if p.collision and isinstance(p.geometry, Cylinder)),
            None,
        )
        if shape is None:
            raise ValueError(f"the item {body.name!r} has no cylinder to judge it by")
        self.radius, self.height = shape.radius, shape.height

    def distance(self, map_from_item: Transform, map_from_link: Transform) -> float:
        """From a link's origin to the nearest point of the item, m."""
        x, y, z = map_from_item.inverse().apply(map_from_link.position)
        beside = max(0.0, math.hypot(x, y) - self.radius)
        above = max(0.0, abs(z - self.height / 2) - self.height / 2)
        return math.hypot(beside, above)


class _Top:
    """The highest box of a table is its top."""

    def __init__(self, body: Body) -> None:
        boxes = [(p.body_from_part, p.geometry) for p in body.parts if isinstance(p.geometry, Box)]
        if not boxes:
            raise ValueError(f"the support {body.name!r} has no box to stand on")
        at, box = max(boxes, key=lambda pair: pair[0].position[2] + pair[1].size[2] / 2)
        self._body_from_surface = at @ Transform((0.0, 0.0, box.size[2] / 2))
        self._half = (box.size[0] / 2, box.size[1] / 2)

    def _on(self, map_from_body: Transform, pose: Transform) -> tuple[float, float, float]:
        x, y, z = (map_from_body @ self._body_from_surface).inverse().apply(pose.position)
        return float(x), float(y), float(z)

    def margin(self, map_from_body: Transform, pose: Transform) -> float:
        """How far a point lies within the nearest edge, m; below 0 beyond it."""
        x, y, _ = self._on(map_from_body, pose)
        return min(self._half[0] - abs(x), self._half[1] - abs(y))

    def height_above(self, map_from_body: Transform, pose: Transform) -> float:
        """Height of a point above the surface, m."""
        return self._on(map_from_body, pose)[2]


def _moved(before: Transform, now: Transform) -> float:
    x, y, z = (float(v) for v in now.position - before.position)
    return math.sqrt(x * x + y * y + z * z)


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.1f} deg"
