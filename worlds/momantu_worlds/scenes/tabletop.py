"""What stands on the tables of an episode: the item, the tag, and what is in their way.

The job stays possible by rule. Around the item nothing is nearer than `gap_to_item`, a lane as
wide as a hand leads to it from somewhere before the table's preferred side, and from where the
robot would stand at least half of it is seen. The tag is seen whole from there. Beside the tag
remains a spot for the item with the same lane.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.world import seeded
from momantu_worlds.scenes.floor import STAND_OFF
from momantu_worlds.scenes.generator import COLORS, draw_look, draw_thing
from momantu_worlds.scenes.layout import PlacedTable, PlacedThing
from momantu_worlds.scenes.objects import ObjectKind, Thing
from momantu_worlds.scenes.tag36h11 import picture_edge
from momantu_worlds.scenes.world_file import WorldFile

TRIES = 80
"""Draws for one thing before it is left out."""
RIM = 0.02
"""m; what everything keeps from the table's edge."""
LANE = 0.07
"""m; half the width of a hand's way to the item: half of Fetch's open gripper, 0.13 m, and air."""
LANE_LENGTH = 0.35
"""m; of that way; farther off the hand is above what stands there."""
LANE_SPREAD = math.radians(60)
"""rad; how far from straight ahead a hand's way may turn."""
EYE = 1.1
"""m; height of a camera above the floor."""
EYE_OFFSETS = (0.0, -0.3, 0.3)
"""m; along the table's edge: places from which the robot would look."""
ITEM_SEEN = 0.5
"""share of the item that must be seen from one of them."""
SPOT_GAP = 0.08
"""m; around a free spot for the item, so that fingers can open."""
SPOT_REACH = 0.5
"""m; the farthest from the preferred edge that a free spot counts."""
SPOT_MARGIN = 0.08
"""m; by which a free spot is nearer to the tag than the goal demands."""


@dataclass(frozen=True, slots=True)
class Disc:
    """An upright cylinder on a table: where, radius and height, m."""

    x: float
    y: float
    radius: float
    height: float


def place_item(world: WorldFile, seed: int) -> Pose2D:
    """The item in its table's frame, kept whole on the top."""
    item = world.item
    return _on_top(world, seed, item.name, item.on, item.at, item.shift, item.radius + RIM)


def place_tag(world: WorldFile, seed: int) -> Pose2D:
    """The tag in its table's frame, its white margin kept whole on the top."""
    tag = world.tag
    corner = picture_edge(tag.edge) / math.sqrt(2.0)
    return _on_top(world, seed, tag.name, tag.on, tag.at, tag.shift, corner)


def _on_top(
    world: WorldFile,
    seed: int,
    name: str,
    table: str,
    at: tuple[float, float],
    shift: float,
    margin: float,
) -> Pose2D:
    draw = seeded(seed, "on top", name)
    half = np.array(world.tables[table].size[:2]) / 2 - margin
    x, y = np.clip(np.array(at) + draw.uniform(-shift, shift, 2), -half, half)
    return Pose2D(float(x), float(y), float(draw.uniform(-math.pi, math.pi)))


def place_things(
    world: WorldFile, seed: int, tables: dict[str, PlacedTable], item_at: Pose2D, tag_at: Pose2D
) -> tuple[PlacedThing, ...]:
    """0 to `most` loose things on each table, all of them leaving the job possible."""
    placed: list[PlacedThing] = []
    for table in tables:
        draw = seeded(seed, "things", table)
        wanted = int(draw.integers(world.distractors.most + 1))
        here: list[PlacedThing] = []
        for i in range(wanted):
            kind = world.distractors.kinds[int(draw.integers(len(world.distractors.kinds)))]
            name = f"{table}_{kind}_{i}"
            paint = seeded(seed, "paint", name) if world.distractors.patterns else None
            thing = draw_distractor(world, kind, draw, paint)
            half = np.array(tables[table].size) / 2 - thing.reach - RIM
            for _ in range(TRIES):
                x, y = draw.uniform(-half, half)
                yaw = float(draw.uniform(-math.pi, math.pi))
                at = Pose2D(float(x), float(y), yaw)
                candidate = PlacedThing(name, thing, table, at)
                if _fine(world, tables, table, [*here, candidate], item_at, tag_at):
                    here.append(candidate)
                    break
        placed += here
    return tuple(placed)


def draw_distractor(
    world: WorldFile,
    kind: ObjectKind,
    draw: np.random.Generator,
    paint: np.random.Generator | None,
) -> Thing:
    """A thing of some usual size, weight and look; a can is never like the item."""
    if kind != "can":
        return draw_thing(kind, draw, paint)
    color = COLORS[int(draw.integers(len(COLORS)))]
    size, item = _other_can(world, draw), world.item
    mass = item.mass * (size[0] ** 2 * size[2]) / (4 * item.radius**2 * item.height)
    color = item.color if draw.random() < 0.5 else color
    look = None if paint is None else draw_look(kind, color, paint)
    return Thing(kind, size, mass, color, look)


OTHER_SIZE = 0.22
"""relative; another can differs from the item by more than 20 % in radius or height."""


def _other_can(world: WorldFile, draw: np.random.Generator) -> tuple[float, float, float]:
    factors = draw.uniform(0.85, 1.15, 2)
    larger = bool(draw.random() < 0.5)
    factor = draw.uniform(1 + OTHER_SIZE, 1.38) if larger else draw.uniform(0.68, 1 - OTHER_SIZE)
    factors[int(draw.integers(2))] = factor
    edge = 2 * world.item.radius * float(factors[0])
    return edge, edge, world.item.height * float(factors[1])


def _fine(
    world: WorldFile,
    tables: dict[str, PlacedTable],
    table: str,
    things: Sequence[PlacedThing],
    item_at: Pose2D,
    tag_at: Pose2D,
) -> bool:
    discs = [Disc(t.at.x, t.at.y, t.thing.reach, t.thing.height) for t in things]
    last, others = discs[-1], discs[:-1]
    rule = world.distractors
    if any(_gap(last, other) < rule.gap for other in others):
        return False
    side = world.tables[table].sides[0]
    placed = tables[table]
    if table == world.item.on:
        item = Disc(item_at.x, item_at.y, world.item.radius, world.item.height)
        if _gap(last, item) < rule.gap_to_item or not lane(item, discs, side):
            return False
        if seen_share(outline_points(item), discs, placed, side, item) < ITEM_SEEN:
            return False
    if table == world.tag.on:
        corner = picture_edge(world.tag.edge) / math.sqrt(2.0)
        tag = Disc(tag_at.x, tag_at.y, corner, 0.0)
        if (
            _gap(last, tag) < 0
            or seen_share(tag_points(tag_at, corner), discs, placed, side, tag) < 1
        ):
            return False
    if table != world.goal.on:
        return True
    wanted = SetDown(world.item.radius, world.item.height, world.goal.distance, side)
    return bool(free_spots(wanted, placed, discs, tag_at))


def _gap(a: Disc, b: Disc) -> float:
    return math.hypot(a.x - b.x, a.y - b.y) - a.radius - b.radius


def lane(target: Disc, discs: Iterable[Disc], side: float) -> bool:
    """Whether a hand gets to a target along some straight way from before the preferred side."""
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
    """Largest share of points (n, 3), in the top's frame, that one of the views has a line to."""
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
    """Points on the outline of a cylinder: its rims and its middle, eight around."""
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
    """What is to be set down: its radius and height, within `distance` of the tag, m.

    side: the table's preferred side, in its own frame, rad.
    """

    radius: float
    height: float
    distance: float
    side: float


def free_spots(
    wanted: SetDown, table: PlacedTable, discs: Sequence[Disc], tag_at: Pose2D
) -> list[tuple[float, float]]:
    """Places (x, y) in the table's frame where the item could be set down beside the tag."""
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
                and edge - (x * cos + y * sin) <= SPOT_REACH
                and all(_gap(spot, disc) >= SPOT_GAP for disc in discs)
                and lane(spot, discs, side)
            ):
                spots.append((x, y))
    return spots
