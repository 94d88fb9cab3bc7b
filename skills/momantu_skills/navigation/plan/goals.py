"""Stands: before a surface, within reach of a pose, or at a given pose."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.robot import Working
from momantu_bt.world import Surface

LATERAL = (0.0, 0.4, -0.4)
"""m along the edge: the middle first, then from either side of it."""
BACK = (0.0, 0.08, 0.16, 0.25)
"""m farther off, tried in turn where something stands in the nearest place."""
ON_SURFACE = 0.20
"""m by which a pose may lie beyond a surface's nominal edge and still be on it: tables move."""
SHIFTS = (0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3)
"""m along the edge by which one may stand beside the point that is to be reached."""
STRAIGHT = 0.25
"""m: as far beside it as one may stand where that is straight ahead."""
MANOEUVRE = 0.25
"""Cost of not being straight ahead, m: a turn, a drive and a turn take as long as a metre's way."""
SQUARE = 0.3
"""rad off a side's axis up to which the base stands squarely before it."""
NEARER = 0.05
"""m nearer than the place to look from at which the base is too near: its tolerance."""
AS_NEAR = 0.1
"""m farther off than the nearest place to stand that is as good, where none is near enough."""
RING = 16
"""Directions from which a pose in the open is approached."""


@dataclass(frozen=True, slots=True)
class Stand:
    """One place to stand. variant: stands of one variant differ in stand-off alone. cost: m."""

    pose: Pose2D
    variant: int
    cost: float


def before_surface(surface: Surface, working: Working, base: Pose2D | None = None) -> list[Stand]:
    """Stands from which a surface can be looked over, best first, facing its middle (map).

    A `base` that stands squarely before a side, too near to look, had best back straight off: an
    arm that still reaches over the surface then sweeps over nothing.
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

    Square before the surface that it lies on; around it where it lies on none. `base` is where
    the robot stands: the shorter way is better. What lies too far from all of a surface's edges is
    approached as near as the surface lets: its near side, at least, is within reach.
    """
    stands: list[Stand] = []
    surface = surface_at(target, surfaces)
    if surface is not None:
        here = surface.map_from_surface.inverse() @ Pose2D(*target)
        square = list(_square_stands(surface, here, base, working))
        stands = [stand for away, stand in square if away <= working.reach[2]]
        nearest = min((away for away, _ in square), default=0.0)
        stands = stands or [stand for away, stand in square if away <= nearest + AS_NEAR]
    if not stands:
        for k in range(RING):
            yaw = wrap_angle(2.0 * math.pi * k / RING)
            pose = Pose2D(
                target[0] - working.reach[1] * math.cos(yaw),
                target[1] - working.reach[1] * math.sin(yaw),
                yaw,
            )
            stands.append(Stand(pose, k, pose.distance_to(base)))
    return sorted(stands, key=lambda stand: stand.cost)


def surface_at(target: tuple[float, float], surfaces: Iterable[Surface]) -> Surface | None:
    """The first surface that a point (x, y) of the map lies on, or nearly so."""
    for surface in surfaces:
        here = surface.map_from_surface.inverse() @ Pose2D(*target)
        beyond = max(abs(here.x) - surface.size[0] / 2, abs(here.y) - surface.size[1] / 2)
        if beyond < ON_SURFACE:
            return surface
    return None


def _square_stands(
    surface: Surface, target: Pose2D, base: Pose2D, working: Working
) -> Iterable[tuple[float, Stand]]:
    """Every stand square before one of the sides, with its distance from the target, m."""
    nearest, best, _ = working.reach
    for number, angle in enumerate(surface.sides):
        edge, _ = _edge(surface, angle)
        c, s = math.cos(angle), math.sin(angle)
        out, along = c * target.x + s * target.y, -s * target.x + c * target.y
        closest = max(edge - out + working.stand_off, nearest)
        ahead = surface.map_from_surface.inverse() @ base
        straight = -s * ahead.x + c * ahead.y - along
        shifts = (*SHIFTS, straight) if abs(straight) <= STRAIGHT else SHIFTS
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


def _straight_ahead(base: Pose2D, stand: Pose2D) -> bool:
    """Whether the base only has to drive on to get there."""
    seen = stand.inverse() @ base
    return seen.x < 0.02 and abs(seen.y) < 0.03 and abs(seen.yaw) < 0.3


def _edge(surface: Surface, angle: float) -> tuple[float, float]:
    """Distance from the centre to the edge in direction `angle`, and half that edge's length."""
    c, s = abs(math.cos(angle)), abs(math.sin(angle))
    x, y = surface.size[0] / 2, surface.size[1] / 2
    return c * x + s * y, s * x + c * y


def _facing(angle: float, off: float, lateral: float) -> Pose2D:
    """In the surface's frame: `off` m out from its centre towards `angle`, facing it squarely."""
    c, s = math.cos(angle), math.sin(angle)
    return Pose2D(c * off - s * lateral, s * off + c * lateral, wrap_angle(angle + math.pi))
