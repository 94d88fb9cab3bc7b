"""The judge: compares claims of skills with ground truth at the same moment."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Protocol

import numpy as np

from momantu_bt import claim as say
from momantu_bt.geometry import Array, Pose2D, Transform, wrap_angle
from momantu_bt.messages import ObjectClass
from momantu_bt.robot import RobotDescription
from momantu_worlds.scenes.catalogue.tags import shown_by
from momantu_worlds.scenes.geometry.bodies import Body, Picture
from momantu_worlds.scenes.geometry.solids import FLUSH, LevelTop, PlacedBody, Scene
from momantu_worlds.scenes.referee.demand import tilt

UPRIGHT = math.radians(10.0)
"""Largest angle from the vertical at which an object stands upright, rad."""
LYING_TURN = math.radians(20.0)
"""Largest angle between the axis of a lying object and where it is said to point, rad, either end
forward: closing fingers turn it by as much."""
LIFTED = 0.003
"""Height above everything below it at which an object is lifted, m: six times the jitter of the
physics."""
ALIKE = 0.12
"""Largest relative difference of sizes at which an object is the requested one; others differ by
0.22."""
ROOM_ABOVE = 0.3
"""Height above a top up to which objects obstruct placing, m."""
GRID = 0.02
"""Distance between the points that are tried in the search for room, m."""
ON_TAG = (0.002, 0.01, 0.03)
"""Heights above a tag at which covering objects are searched, m."""
PADS = (5, 9, 3)
"""Points along, across and up, at which the space between the pads is checked."""


class GroundTruth(Protocol):
    """What a simulator tells a judge."""

    def pose(self, body: str, /) -> Transform:
        """`map_from_body`."""
        ...

    def link(self, name: str, /) -> Transform:
        """`map_from_link`."""
        ...

    def base(self) -> Pose2D:
        """`map_from_base`."""
        ...

    def joint(self, name: str, /) -> float:
        """A joint's position, rad or m."""
        ...


class ClaimJudge:
    """Judges sentences at one moment of an episode. bodies: all bodies, by name."""

    def __init__(
        self, description: RobotDescription, bodies: Mapping[str, Body], truth: GroundTruth
    ) -> None:
        self._description, self._bodies, self._truth = description, bodies, truth
        self._scene = Scene(bodies, truth.pose)

    def judge(self, sentence: say.Sentence, odom_from_base: Transform) -> bool | None:
        """See `momantu_bt.claim.Judge.judge`."""
        map_from_odom = self._truth.base().transform() @ odom_from_base.inverse()
        match sentence:
            case say.ObjectAt(asked, pose, tolerance):
                rest = map_from_odom @ pose
                return any(
                    _apart(thing.centre, rest.position) <= tolerance
                    for thing in self._resting(rest)
                    if _meant(asked, thing)
                )
            case say.ObjectOn(asked, surface):
                return self._known(surface) and any(
                    surface in (None, self._scene.below(t)[0]) for t in self._such(asked)
                )
            case say.TagAt(tag_id, pose, tolerance, turn, family):
                return self._tag_at((family, tag_id), map_from_odom @ pose, tolerance, turn)
            case say.TagOn(tag_id, surface, family):
                return self._known(surface) and self._tag_on((family, tag_id), surface)
            case say.CameraAt(frame, pose, tolerance, turn):
                camera = self._truth.link(frame)
                near = _apart(camera.position, pose.position) <= tolerance
                return near and camera.angle_to(pose) <= turn
            case say.PlaneAt(pose, tolerance):
                return any(self._tops_at(map_from_odom.apply(pose.position), tolerance))
            case say.RoomAt(point, radius, tolerance, within):
                return self._room(map_from_odom.apply(point), radius, tolerance, within)
            case say.BaseAt(pose, tolerance, turn):
                off = pose.inverse() @ self._truth.base()
                return math.hypot(off.x, off.y) <= tolerance and abs(off.yaw) <= turn
            case say.BaseNear(point, distance):
                there = map_from_odom.apply((*point, 0.0))
                return self._truth.base().distance_to(Pose2D(*there[:2])) <= distance
            case say.CameraOn(frame, point, turn):
                return self._off_axis(frame, map_from_odom.apply(point)) <= turn
            case say.Holding(something):
                return any(self._held(thing) for thing in self._scene.loose()) is something
            case say.GripperOpen(width):
                return self._opening() >= width
            case say.SetDown(pose, tolerance):
                spot = map_from_odom @ pose
                return any(
                    _apart(t.centre, spot.position) <= tolerance and not self._gripped(t)
                    for t in self._resting(spot)
                )
            case say.JointsAt(names, positions, tolerance):
                pairs = zip(names, positions, strict=True)
                return all(abs(self._joint_off(n, p)) <= tolerance for n, p in pairs)

    def _known(self, surface: str | None) -> bool | None:
        """True, or None for a surface that is not a body here."""
        return True if surface is None or surface in self._bodies else None

    # things

    def _standing(self) -> Iterator[PlacedBody]:
        for thing in self._scene.loose():
            if tilt(thing.pose) <= UPRIGHT and abs(self._scene.below(thing)[1]) <= FLUSH:
                yield thing

    def _resting(self, as_at: Transform) -> Iterator[PlacedBody]:
        """Loose things that rest as one at that pose does: upright, or lying the same way."""
        level = np.array([*as_at.rotation[:2, 2], 0.0])
        if float(np.linalg.norm(level)) < math.sin(math.pi / 4):
            yield from self._standing()
            return
        level /= np.linalg.norm(level)
        for thing in self._scene.loose():
            axis = thing.pose.rotation[:, 2]
            lies = abs(float(axis[2])) <= math.sin(UPRIGHT)
            along = abs(float(axis @ level)) >= math.cos(LYING_TURN)
            if lies and along and abs(self._scene.below(thing)[1]) <= FLUSH:
                yield thing

    def _such(self, asked: ObjectClass) -> Iterator[PlacedBody]:
        return (thing for thing in self._standing() if _meant(asked, thing))

    # tags

    def _pictures(self) -> Iterator[tuple[Transform, Picture]]:
        for name, body in self._bodies.items():
            for part in body.parts:
                if isinstance(part.geometry, Picture):
                    yield self._truth.pose(name) @ part.body_from_part, part.geometry

    def _tags(self, tag: tuple[str, int]) -> Iterator[tuple[Transform, Picture]]:
        """The pictures that show a tag of a family and an id."""
        for pose, picture in self._pictures():
            if shown_by(picture.pixels) == tag:
                yield pose, picture

    def _tag_at(
        self, wanted: tuple[str, int], there: Transform, tolerance: float, turn: float
    ) -> bool:
        return any(
            _apart(tag.position, there.position) <= tolerance and tag.angle_to(there) <= turn
            for tag, _ in self._tags(wanted)
        )

    def _tag_on(self, wanted: tuple[str, int], surface: str | None) -> bool:
        for tag, picture in self._tags(wanted):
            lies_on = {top.body for top in self._tops_at(tag.position, FLUSH)}
            if (surface is None or surface in lies_on) and not self._covered(tag, picture):
                return True
        return False

    def _covered(self, tag: Transform, picture: Picture) -> bool:
        x, y = (np.linspace(-edge / 2, edge / 2, 9) for edge in picture.size)
        points = tag.apply(np.array([(a, b, c) for a in x for b in y for c in ON_TAG]))
        return any(bool(thing.inside(points).any()) for thing in self._scene.solid()) or any(
            _lies_on(tag.inverse() @ other, sheet, picture) for other, sheet in self._pictures()
        )

    # tops

    def _tops_at(self, point: Array, tolerance: float) -> Iterator[LevelTop]:
        for top in self._scene.tops:
            if abs(top.height - point[2]) <= tolerance and top.margin(point) >= 0.0:
                yield top

    def _room(self, point: Array, radius: float, tolerance: float, within: float) -> bool:
        steps = np.arange(-within, within + GRID / 2, GRID) if within > 0.0 else np.zeros(1)
        tries = np.array([(x, y, 0.0) for x in steps for y in steps if math.hypot(x, y) <= within])
        tops = [top for top in self._scene.tops if abs(top.height - point[2]) <= tolerance]
        for top in tops:
            things = [
                solid
                for thing in self._scene.solid()
                for solid in thing.solids
                if solid.vertices[:, 2].max() - top.height > FLUSH
                and solid.vertices[:, 2].min() - top.height < ROOM_ABOVE
                and not self._gripped(thing)
            ]
            for spot in point + tries:
                if top.margin(spot) >= radius and all(
                    solid.beside(spot[:2]) >= radius for solid in things
                ):
                    return True
        return False

    # the robot

    def _held(self, thing: PlacedBody) -> bool:
        return self._gripped(thing) and self._scene.below(thing)[1] > LIFTED

    def _gripped(self, thing: PlacedBody) -> bool:
        """Whether any part of an object is between the pads."""
        if self._description.end_effector is None:
            return False
        return bool(thing.inside(self._between_pads).any())

    @cached_property
    def _between_pads(self) -> Array:
        """Points (n, 3) in the map between the gripper's pads."""
        hand = self._description.hand
        extent = (hand.pad_length, self._opening(), hand.pad_height)
        axes = [np.linspace(-e / 2, e / 2, n) for e, n in zip(extent, PADS, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        grasp = self._truth.link(hand.frame) @ Transform((hand.grasp_offset, 0.0, 0.0))
        return np.asarray(grasp.apply(grid))

    def _opening(self) -> float:
        hand = self._description.hand
        return hand.width({name: self._truth.joint(name) for name in hand.opening})

    def _off_axis(self, frame: str, point: Array) -> float:
        """Angle between an optical frame's z axis and the direction to a point, rad."""
        x, y, z = self._truth.link(frame).inverse().apply(point)
        return math.atan2(math.hypot(x, y), z)

    def _joint_off(self, name: str, position: float) -> float:
        off = self._truth.joint(name) - position
        return wrap_angle(off) if self._description.joint_limits[name].lower is None else off


def _lies_on(lower_from_upper: Transform, upper: Picture, lower: Picture) -> bool:
    """Whether a picture covers a part of another one beneath it."""
    x, y, z = lower_from_upper.position
    reach = (math.hypot(*upper.size) + min(lower.size)) / 2
    return 0.0 < z <= ON_TAG[-1] and math.hypot(x, y) < reach


def _apart(a: Array, b: Array) -> float:
    return float(np.linalg.norm(a - b))


def _meant(asked: ObjectClass, thing: PlacedBody) -> bool:
    """Whether an object is of the category, and of the sizes that are known."""
    if thing.body.category != asked.category:
        return False
    x, y, z = (float(v) for v in thing.size)
    if asked.diameter is not None and not _alike(min(x, y), asked.diameter):
        return False
    if asked.height is not None and not _alike(z, asked.height):
        return False
    across = [v for v in (asked.width, asked.depth) if v is not None]
    ways = ((x, y), (y, x))
    return any(all(_alike(v, a) for v, a in zip(way, across, strict=False)) for way in ways)


def _alike(size: float, asked: float) -> bool:
    return abs(size - asked) <= ALIKE * asked
