"""Upright cylinders on a top: free paths for the hand, lines of sight, free spots."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.scenes.arrange.floor import STAND_OFF
from momantu_worlds.scenes.arrange.layout import PlacedTable

LANE = 0.07
"""Half the width of the hand's free path to the item, m: half of Fetch's open gripper and a
margin."""
LANE_LENGTH = 0.35
"""Length of that path, m; farther away the hand is above other objects."""
LANE_SPREAD = math.radians(60)
"""Largest angle of that path to straight ahead, rad."""
EYE = 1.1
"""Height of the assumed camera above the floor, m."""
EYE_OFFSETS = (0.0, -0.3, 0.3)
"""Offsets of the assumed viewpoints along the table's edge, m."""
SPOT_GAP = 0.08
"""Free distance around a spot for the item, m, so that the fingers can open."""
SPOT_REACH = 0.5
"""Largest distance of a free spot from the preferred edge, m."""
SPOT_MARGIN = 0.08
"""A free spot is nearer to the tag than the goal demands by this much, m."""


@dataclass(frozen=True, slots=True)
class Disc:
    """An upright cylinder on a table: its position, radius and height, m."""

    x: float
    y: float
    radius: float
    height: float


def gap(a: Disc, b: Disc) -> float:
    """Distance between two cylinders along the top, m; negative if they overlap."""
    return math.hypot(a.x - b.x, a.y - b.y) - a.radius - b.radius


def lane(target: Disc, discs: Iterable[Disc], side: float) -> bool:
    """Whether a straight free path for the hand leads from the preferred side to a target."""
    blocking = [d for d in discs if d != target]
    for turn in np.linspace(-LANE_SPREAD, LANE_SPREAD, 9):
        cos, sin = math.cos(side + turn), math.sin(side + turn)
        for disc in blocking:
            dx, dy = disc.x - target.x, disc.y - target.y
            along = min(max(dx * cos + dy * sin, 0.0), LANE_LENGTH)
            if math.hypot(dx - along * cos, dy - along * sin) < LANE + disc.radius:
                break
        else:
            return True
    return False


def seen_share(
    points: Array, discs: Sequence[Disc], table: PlacedTable, side: float, target: Disc
) -> float:
    """Largest share of points (n, 3), in the top's frame, that is visible from one viewpoint."""
    cos, sin = math.cos(side), math.sin(side)
    half = table.size[0] / 2 if abs(cos) > abs(sin) else table.size[1] / 2
    lateral = target.y * cos - target.x * sin
    best = 0.0
    for offset in EYE_OFFSETS:
        out, along = half + STAND_OFF, lateral + offset
        eye = np.array([out * cos - along * sin, out * sin + along * cos, EYE - table.height])
        hidden = np.zeros(len(points), dtype=np.bool_)
        for disc in discs:
            hidden |= _behind(points, eye, disc)
        best = max(best, 1.0 - float(np.mean(hidden)))
    return best


def _behind(points: Array, eye: Array, disc: Disc) -> NDArray[np.bool_]:
    """Which segments from the eye to points (n, 3) pass through an upright cylinder."""
    ray = points - eye
    from_axis = eye[:2] - (disc.x, disc.y)
    a = np.einsum("ij,ij->i", ray[:, :2], ray[:, :2])
    b = ray[:, :2] @ from_axis
    c = float(from_axis @ from_axis) - disc.radius**2
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    enter, leave = (-b - root) / a, (-b + root) / a
    # a ray comes down: it meets the cylinder when it is below the top before it leaves it
    low = eye[2] + np.clip(leave, 0.0, 1.0) * ray[:, 2]
    return np.asarray((b * b > a * c) & (enter < 1.0) & (leave > 0.0) & (low < disc.height))


def outline_points(disc: Disc) -> Array:
    """Points on the outline of a cylinder: bottom, middle and top rims, eight around each."""
    turns = np.arange(8) * (math.pi / 4)
    ring = np.stack([disc.x + disc.radius * np.cos(turns), disc.y + disc.radius * np.sin(turns)], 1)
    heights = (0.15, 0.5, 1.0)
    return np.concatenate([np.column_stack([ring, np.full(8, disc.height * h)]) for h in heights])


def tag_points(at: Pose2D, corner: float) -> Array:
    """Corners, edge middles and centre of the tag's picture."""
    turns = at.yaw + np.arange(8) * (math.pi / 4)
    reach = np.where(np.arange(8) % 2 == 1, corner, corner / math.sqrt(2.0))
    around = np.stack([at.x + reach * np.cos(turns), at.y + reach * np.sin(turns)], axis=1)
    return np.column_stack([np.concatenate([around, [(at.x, at.y)]]), np.zeros(9)])


@dataclass(frozen=True, slots=True)
class SetDown:
    """An object to place: its radius and height; at most `distance` from the tag, m.

    side: the table's preferred side, in its own frame, rad.
    """

    radius: float
    height: float
    distance: float
    side: float


def free_spots(
    wanted: SetDown, table: PlacedTable, discs: Sequence[Disc], tag_at: Pose2D
) -> list[tuple[float, float]]:
    """Positions (x, y) in the table's frame where the item can be placed beside the tag."""
    side, near = wanted.side, wanted.distance - SPOT_MARGIN
    cos, sin = math.cos(side), math.sin(side)
    half = np.array(table.size) / 2 - wanted.radius - 0.03
    edge = table.size[0] / 2 if abs(cos) > abs(sin) else table.size[1] / 2
    spots = []
    steps = np.arange(-near, near + 1e-9, 0.05)
    for dx in steps:
        for dy in steps:
            x, y = tag_at.x + float(dx), tag_at.y + float(dy)
            spot = Disc(x, y, wanted.radius, wanted.height)
            if (
                math.hypot(dx, dy) <= near
                and abs(x) <= half[0]
                and abs(y) <= half[1]
                and not (table.round and math.hypot(x, y) > half[0])
                and edge - (x * cos + y * sin) <= SPOT_REACH
                and all(gap(spot, disc) >= SPOT_GAP for disc in discs)
                and lane(spot, discs, side)
            ):
                spots.append((x, y))
    return spots
