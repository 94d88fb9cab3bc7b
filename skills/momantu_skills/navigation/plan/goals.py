"""Stands, the candidates for a goal pose: before a surface, within reach of a pose, or given."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.robot import Working
from momantu_bt.world import Surface

LATERAL = (0.0, 0.4, -0.4)
"""Offsets along the edge, m: the middle first, then to either side."""
BACK = (0.0, 0.08, 0.16, 0.25)
"""Extra distances from the surface, m, tried in turn if an obstacle occupies the nearest place."""
ON_SURFACE = 0.20
"""How far a pose may lie beyond a surface's nominal edge and still be on it, m, as tables move."""
SHIFTS = (0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3)
"""Offsets along the edge, m, between the goal pose and the point to reach."""
STRAIGHT = 0.25
"""Largest such offset for a goal pose straight ahead of the base, m."""
MANOEUVRE = 0.25
"""Cost of a goal pose that is not straight ahead, m: turning, driving and turning again takes as
long as driving one metre."""
SQUARE = 0.3
"""Largest angle to a side's axis at which the base faces the side squarely, rad."""
NEARER = 0.05
"""The base is too near if it is this much nearer than the working distance, m: its tolerance."""
AS_NEAR = 0.1
"""If no stand is near enough, stands up to this much farther than the nearest one count as equal,
m."""
BESIDE_SIDE = math.radians(50.0)
"""Largest angle to a round surface's side of directions from which it is approached too, rad."""
RING = 16
"""Number of directions from which a pose away from surfaces is approached."""


@dataclass(frozen=True, slots=True)
class Stand:
    """One candidate goal pose. Stands of one variant differ only in their distance. cost: m."""

    pose: Pose2D
    variant: int
    cost: float


def before_surface(surface: Surface, working: Working, base: Pose2D | None = None) -> list[Stand]:
    """Stands from which a surface can be viewed, best first, facing its middle (map).

    If `base` faces a side squarely but is too near to see the surface, backing straight up is best:
    an arm that still extends over the surface then does not sweep over other things.
    """
    stands = [] if base is None else _straight_back(surface, base, working)
    variant = len(stands)
    for angle in surface.sides:
        edge, half = _edge(surface, angle)
        for lateral in LATERAL:
            if abs(lateral) > half:
                continue
            for back in BACK:
                off = edge + working.look_off + back
                pose = surface.map_from_surface @ _facing(angle, off, lateral)
                turned = math.atan2(-lateral, off)
                pose = Pose2D(pose.x, pose.y, wrap_angle(pose.yaw - turned))
                stands.append(Stand(pose, variant, variant + back))
            variant += 1
    return stands


def _straight_back(surface: Surface, base: Pose2D, working: Working) -> list[Stand]:
    here = surface.map_from_surface.inverse() @ base
    for angle in surface.sides:
        edge, half = _edge(surface, angle)
        c, s = math.cos(angle), math.sin(angle)
        out, along = c * here.x + s * here.y, -s * here.x + c * here.y
        square = abs(wrap_angle(here.yaw - angle - math.pi)) < SQUARE and abs(along) < half
        if square and edge < out < edge + working.look_off - NEARER:
            own = _facing(angle, edge + working.look_off, along)
            return [Stand(surface.map_from_surface @ own, 0, -1.0)]
    return []


def within_reach(
    target: tuple[float, float],
    surfaces: Iterable[Surface],
    base: Pose2D,
    working: Working,
) -> list[Stand]:
    """Stands from which a point (x, y) can be reached, best first; all in the map.

    If the point lies on a surface, the stands face that surface squarely; otherwise they lie around
    the point. `base` is where the robot stands: a shorter drive is better. If the point is too far
    from all edges of its surface, the stands are as near as the surface allows.

    An arm that reaches to the side, or beside the base's middle, stands so that the point lies on
    its line of reach.
    """
    line = working.base_from_reach
    if line == Pose2D(0.0, 0.0, 0.0):
        return _before(target, surfaces, base, working)
    stands = _before(target, surfaces, base @ line, working)
    return [replace(stand, pose=stand.pose @ line.inverse()) for stand in stands]


def _before(
    target: tuple[float, float],
    surfaces: Iterable[Surface],
    base: Pose2D,
    working: Working,
) -> list[Stand]:
    stands: list[Stand] = []
    surface = surface_at(target, surfaces)
    if surface is not None:
        here = surface.map_from_surface.inverse() @ Pose2D(*target)
        square = list(_square_stands(surface, here, base, working))
        stands = [stand for away, stand in square if away <= working.reached[2]]
        nearest = min((away for away, _ in square), default=0.0)
        stands = stands or [stand for away, stand in square if away <= nearest + AS_NEAR]
    if not stands:
        for k in range(RING):
            yaw = wrap_angle(2.0 * math.pi * k / RING)
            pose = Pose2D(
                target[0] - working.reached[1] * math.cos(yaw),
                target[1] - working.reached[1] * math.sin(yaw),
                yaw,
            )
            stands.append(Stand(pose, k, pose.distance_to(base)))
    return sorted(stands, key=lambda stand: stand.cost)


def surface_at(target: tuple[float, float], surfaces: Iterable[Surface]) -> Surface | None:
    """The first surface that a point (x, y) of the map lies on, within tolerance."""
    for surface in surfaces:
        here = surface.map_from_surface.inverse() @ Pose2D(*target)
        beyond = max(abs(here.x) - surface.size[0] / 2, abs(here.y) - surface.size[1] / 2)
        if surface.round:
            beyond = math.hypot(here.x, here.y) - surface.size[0] / 2
        if beyond < ON_SURFACE:
            return surface
    return None


def _square_stands(
    surface: Surface, target: Pose2D, base: Pose2D, working: Working
) -> Iterable[tuple[float, Stand]]:
    """All stands that face one of the sides squarely, with their distance from the target, m."""
    nearest, best, _ = working.reached
    for number, angle in enumerate(_directions(surface, target)):
        edge, _ = _edge(surface, angle)
        c, s = math.cos(angle), math.sin(angle)
        out, along = c * target.x + s * target.y, -s * target.x + c * target.y
        closest = max(edge - out + working.stand_off, nearest)
        ahead = surface.map_from_surface.inverse() @ base
        straight = -s * ahead.x + c * ahead.y - along
        shifts: tuple[float, ...] = (*SHIFTS, straight) if abs(straight) <= STRAIGHT else SHIFTS
        if working.breadth is not None:
            shifts = tuple(shift for shift in shifts if abs(shift) <= working.breadth)
        for index, shift in enumerate(shifts):
            for back in BACK:
                away = max(closest + back, min(best, closest + 0.05))
                distance = math.hypot(away, shift)
                pose = surface.map_from_surface @ _facing(angle, out + away, along + shift)
                cost = (
                    2.0 * abs(distance - best)
                    + 3.0 * shift * shift
                    + 0.3 * number
                    + 0.3 * min(pose.distance_to(base), 3.0)
                    + (0.0 if _straight_ahead(base, pose) else MANOEUVRE)
                )
                yield distance, Stand(pose, number * (len(SHIFTS) + 1) + index, cost)


def _directions(surface: Surface, target: Pose2D) -> tuple[float, ...]:
    """Directions in a surface's frame from which it is approached squarely, preferred first.

    A round one has no corners: beside its sides these are the directions in between, next to a
    side, the nearest to the target first.
    """
    if not surface.round:
        return surface.sides
    bearing = math.atan2(target.y, target.x)
    between = [
        angle
        for angle in (wrap_angle(2 * math.pi * k / RING) for k in range(RING))
        if 1e-6 < min(abs(wrap_angle(angle - side)) for side in surface.sides) <= BESIDE_SIDE
    ]
    every = (*surface.sides, *between)
    return tuple(sorted(every, key=lambda angle: round(abs(wrap_angle(angle - bearing)), 6)))


def _straight_ahead(base: Pose2D, stand: Pose2D) -> bool:
    """Whether the base only has to drive straight ahead to the stand."""
    seen = stand.inverse() @ base
    return seen.x < 0.02 and abs(seen.y) < 0.03 and abs(seen.yaw) < 0.3


def _edge(surface: Surface, angle: float) -> tuple[float, float]:
    """Distance from the centre to the edge in direction `angle`, and half that edge's length."""
    c, s = abs(math.cos(angle)), abs(math.sin(angle))
    x, y = surface.size[0] / 2, surface.size[1] / 2
    if surface.round:
        return x, x
    return c * x + s * y, s * x + c * y


def _facing(angle: float, off: float, lateral: float) -> Pose2D:
    """Pose in the surface's frame: `off` m from its centre towards `angle`, facing back."""
    c, s = math.cos(angle), math.sin(angle)
    return Pose2D(c * off - s * lateral, s * off + c * lateral, wrap_angle(angle + math.pi))
