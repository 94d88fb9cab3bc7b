"""Whether a hand may grasp a wide object by its rim: what is hollow is seen, not guessed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.hand.grasps import ROOM, Grasp
from momantu_skills.manipulation.scene.surroundings import SeenSpace

WALL = 0.012
"""Assumed thickness of the walls on the way of the fingers, m, inwards from the outline."""
SIDES = 16
"""Pieces of a round wall."""
STEP = 0.006
"""Distance between points that are looked at inside an object, m."""
SLACK = 0.008
"""How far a picture must show something behind a point for it to be free, m: three sigma of the
depth noise at 1.6 m. A camera whose depth is wrong by a share is wrong alike for both: they lie
side by side in one picture."""
SEEN = 0.9
"""Least share of the points in the finger's place that pictures showed to be free."""
NEAR = 0.02
"""Distance from the rim's expected place within which points show it, m."""
FEW = 3
"""Points (every fourth pixel in each direction) that prove a rim: one at 1 m has eight."""
SHIFTS = (0.0, 0.5)
"""Positions of the inner finger that are looked at, as shares of its way to the wall."""


def seen_hollow(
    space: SeenSpace, thing: DetectedObject, grasp: Grasp, fingers: Sequence[Array]
) -> bool:
    """Whether pictures showed that the inner finger has room inside the object.

    fingers: planes (k, 4) around each open finger in the grasp frame, outward normal and offset.
    """
    points = _inner_place(thing, grasp, fingers)
    if not len(points):
        return True
    free = space.free(thing.pose.transform.apply(points), SLACK)
    return float(free.mean()) >= SEEN


def seen_rim(points: Array, thing: DetectedObject, grasp: Grasp) -> bool:
    """Whether points (n, 3) of a picture, odom, show an edge between the pads."""
    place = np.array(grasp.object_from_grasp.position)
    place[2] = thing.size[2] / 2
    away = np.linalg.norm(points - thing.pose.transform.apply(place), axis=1)
    return int((away < NEAR).sum()) >= FEW


def held_by_rim(held: HeldObject) -> bool:
    """Whether the fingers hold an object at its wall: their middle is far from its axis."""
    across = float(held.grasp_from_object.position[1])
    return abs(across) > min(held.object.size[:2]) / 4


def wall_pieces(thing: DetectedObject) -> list[Array]:
    """Corners (8, 3) of the convex pieces of an object's wall, in its frame, m."""
    height = thing.size[2] / 2
    return [
        np.vstack([np.column_stack([flat, np.full(4, z)]) for z in (-height, height)])
        for flat in _outline_pieces(thing)
    ]


def _outline_pieces(thing: DetectedObject) -> list[Array]:
    half = np.array(thing.size[:2]) / 2
    if thing.shape == "cylinder":
        turns = np.arange(SIDES + 1) * (2 * math.pi / SIDES)
        outer = float(half.max()) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    else:
        outer = half * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)], dtype=np.float64)
    inner = outer * np.maximum(0.0, 1.0 - WALL / half)
    return [np.vstack([outer[i : i + 2], inner[i : i + 2]]) for i in range(len(outer) - 1)]


def _inner_place(thing: DetectedObject, grasp: Grasp, fingers: Sequence[Array]) -> Array:
    """Points (n, 3), in the object's frame, inside its wall where a finger is or passes."""
    inside = _interior(thing)
    local = grasp.object_from_grasp.inverse().apply(inside)
    place = np.zeros(len(inside), dtype=np.bool_)
    inward = _inward(grasp)
    for planes in fingers:
        # a closing finger moves along y towards the wall, half of the opening at most
        offset = _inner_face(planes, inward)
        for share in SHIFTS:
            moved = local + np.array((0.0, share * offset * inward, 0.0))
            place |= (moved @ planes[:, :3].T + planes[:, 3] < ROOM).all(axis=1)
    return inside[place]


def _inward(grasp: Grasp) -> float:
    """1 if the grasp frame's y points into the object, else -1."""
    pose: Transform = grasp.object_from_grasp
    return 1.0 if float(pose.rotation[:2, 1] @ pose.position[:2]) < 0.0 else -1.0


def _inner_face(planes: Array, inward: float) -> float:
    """Distance of an open finger from the wall between the pads, m; 0 for the outer finger."""
    towards = planes[planes[:, 1] * inward < -0.9]
    return 0.0 if not len(towards) else max(0.0, float(towards[:, 3].max()))


def _interior(thing: DetectedObject) -> Array:
    """Points (n, 3) inside an object's assumed wall, in its frame, m."""
    half = np.array(thing.size) / 2
    axes = [np.arange(-h + STEP / 2, h, STEP) for h in half]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if thing.shape == "cylinder":
        within = np.linalg.norm(points[:, :2], axis=1) < float(half[:2].max()) - WALL
    else:
        within = (np.abs(points[:, :2]) < half[:2] - WALL).all(axis=1)
    return np.asarray(points[within])
