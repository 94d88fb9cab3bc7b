"""Arranging the tables of an episode: the item, the tag and distractors.

Rules ensure that the task stays possible. Nothing is nearer to the item than `gap_to_item`. A path
as wide as the hand leads to it from a place before the table's preferred side, and from a robot's
viewpoint there at least half of the item is visible. The whole tag is visible from there. Beside
the tag there is a free spot for the item with a path of the same width.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_bt.world import seeded
from momantu_worlds.scenes.arrange.layout import PlacedTable, PlacedTag, PlacedThing
from momantu_worlds.scenes.arrange.mesh_files import mesh_parts, mesh_size
from momantu_worlds.scenes.arrange.spots import (
    Disc,
    SetDown,
    free_spots,
    gap,
    lane,
    outline_points,
    seen_share,
    tag_points,
)
from momantu_worlds.scenes.catalogue.objects import ObjectKind, Thing
from momantu_worlds.scenes.catalogue.random_objects import COLORS, draw_look, draw_thing
from momantu_worlds.scenes.catalogue.tags import picture_edge
from momantu_worlds.scenes.file.objects import ObjectNote, TagNote
from momantu_worlds.scenes.file.world import WorldFile

TRIES = 80
"""Draws for one object before it is left out."""
RIM = 0.02
"""Least distance from the table's edge, m."""
APART = 0.01
"""Least gap between two named objects, m."""
AIR = 0.03
"""Least gap between an object and the board above it, m."""
ITEM_SEEN = 0.5
"""Share of the item that must be visible from one viewpoint."""


def place_objects(
    world: WorldFile,
    seed: int,
    tables: Mapping[str, PlacedTable],
    tags: Sequence[PlacedTag],
) -> tuple[PlacedThing, ...]:
    """Place the item and all named objects, each entirely on its top, in the order of the file."""
    placed: list[PlacedThing] = []
    item = {} if world.item is None else {world.item.name: world.item}
    for name, note in {**item, **world.objects}.items():
        placed.append(_placed_object(world, seed, tables, name, note, placed, tags))
    return tuple(placed)


def _placed_object(
    world: WorldFile,
    seed: int,
    tables: Mapping[str, PlacedTable],
    name: str,
    note: ObjectNote,
    before: Sequence[PlacedThing],
    tags: Sequence[PlacedTag],
) -> PlacedThing:
    """Place an object where nothing else stands; after TRIES draws, at the last draw."""
    table = note.tops[int(seeded(seed, "which top", name).integers(len(note.tops)))]
    thing = _thing_of(world, note, seed, name)
    taken = [disc_of(other) for other in before if other.table == table]
    taken += [tag_disc(tag) for tag in tags if tag.table == table]
    spot = Spot(name, table, note.at, note.shift, thing.reach + RIM, note.yaw, note.turn)
    for at in islice(_on_top(tables, seed, spot), TRIES):
        own = Disc(at.x, at.y, thing.reach, thing.height)
        if all(gap(own, other) >= APART for other in taken):
            break
    return PlacedThing(name, thing, table, at, note.friction)


def _thing_of(world: WorldFile, note: ObjectNote, seed: int, name: str) -> Thing:
    """An object with the values of the file; missing values are drawn for its kind."""
    draw = seeded(seed, "object", name)
    paint = seeded(seed, "paint", name) if note.color is None else None
    if note.mesh is None:
        thing = draw_thing(note.kind, draw, paint, size=note.extent, color=note.color)
    else:
        file = world.beside(note.mesh.file)
        size = mesh_size(note.mesh, file)
        parts = mesh_parts(note.mesh, file, standing=True, color=note.color)
        thing = replace(draw_thing(note.kind, draw, paint, size=size), mesh=parts)
    thing = thing if note.mass is None else replace(thing, mass=note.mass)
    return replace(thing, lying=True) if note.lying else thing


def place_tags(
    world: WorldFile, seed: int, tables: Mapping[str, PlacedTable]
) -> tuple[PlacedTag, ...]:
    """Place every tag: entirely on its table, white margin included, or at its place on a wall."""
    placed = []
    for name, note in world.all_tags.items():
        if note.on is None or note.at is None:
            placed.append(PlacedTag(name, note, None, Pose2D(0.0, 0.0)))
            continue
        spot = Spot(name, note.on, note.at, note.shift, tag_corner(note), note.yaw, note.turn)
        placed.append(PlacedTag(name, note, note.on, next(_on_top(tables, seed, spot))))
    return tuple(placed)


@dataclass(frozen=True, slots=True)
class Spot:
    """Range of poses on a top: around a point, or anywhere (`at` None).

    margin: least distance of its centre from the edges, m. yaw, turn: its yaw and range, rad.
    """

    name: str
    table: str
    at: tuple[float, float] | None
    shift: float
    margin: float
    yaw: float = 0.0
    turn: float = math.pi


def _on_top(tables: Mapping[str, PlacedTable], seed: int, spot: Spot) -> Iterator[Pose2D]:
    """Draw poses in the table's frame, without end."""
    draw = seeded(seed, "on top", spot.name)
    half = np.maximum(np.array(tables[spot.table].size) / 2 - spot.margin, 0.0)
    while True:
        if spot.at is None:
            x, y = draw.uniform(-half, half)
        else:
            shift = draw.uniform(-spot.shift, spot.shift, 2)
            x, y = np.clip(np.array(spot.at) + shift, -half, half)
        if tables[spot.table].round:
            x, y = np.array((x, y)) * min(1.0, half[0] / max(math.hypot(x, y), 1e-9))
        yield Pose2D(float(x), float(y), spot.yaw + float(draw.uniform(-spot.turn, spot.turn)))


def place_things(
    world: WorldFile,
    seed: int,
    tables: Mapping[str, PlacedTable],
    objects: Sequence[PlacedThing],
    tags: Sequence[PlacedTag],
) -> tuple[PlacedThing, ...]:
    """Place 0 to `most` distractors on each table so that the goal stays possible."""
    rule = world.distractors
    if rule is None:
        return ()
    placed: list[PlacedThing] = []
    for table in tables if rule.on is None else rule.on:
        crowd = _Crowd(world, tables[table], table, objects, tags)
        draw = seeded(seed, "things", table)
        wanted = int(draw.integers(rule.most + 1))
        here: list[PlacedThing] = []
        for i in range(wanted):
            kind = rule.kinds[int(draw.integers(len(rule.kinds)))]
            name = f"{table}_{kind}_{i}"
            paint = seeded(seed, "paint", name) if rule.patterns else None
            thing = draw_distractor(kind, draw, paint, crowd.sought)
            half = np.array(tables[table].size) / 2 - thing.reach - RIM
            for _ in range(TRIES if (half > 0).all() else 0):
                x, y = draw.uniform(-half, half)
                if tables[table].round and math.hypot(x, y) > half[0]:
                    continue
                yaw = float(draw.uniform(-math.pi, math.pi))
                at = Pose2D(float(x), float(y), yaw)
                candidate = PlacedThing(name, thing, table, at)
                if crowd.takes([*here, candidate]):
                    here.append(candidate)
                    break
        placed += here
    return tuple(placed)


def draw_distractor(
    kind: ObjectKind,
    draw: np.random.Generator,
    paint: np.random.Generator | None,
    sought: Thing | None,
) -> Thing:
    """Draw an object that differs from the item."""
    if sought is None or sought.kind != kind:
        return draw_thing(kind, draw, paint)
    color = COLORS[int(draw.integers(len(COLORS)))]
    size = _other_size(sought, draw)
    mass = sought.mass * (size[0] ** 2 * size[2]) / (sought.size[0] ** 2 * sought.size[2])
    color = sought.color if draw.random() < 0.5 else color
    look = None if paint is None else draw_look(kind, color, paint)
    return Thing(kind, size, mass, color, look)


OTHER_SIZE = 0.22
"""Relative difference: a distractor of the item's kind differs in width or height by more than 20
%."""


def _other_size(sought: Thing, draw: np.random.Generator) -> tuple[float, float, float]:
    factors = draw.uniform(0.85, 1.15, 2)
    larger = bool(draw.random() < 0.5)
    factor = draw.uniform(1 + OTHER_SIZE, 1.38) if larger else draw.uniform(0.68, 1 - OTHER_SIZE)
    factors[int(draw.integers(2))] = factor
    wide, high = (float(factor) for factor in factors)
    return sought.size[0] * wide, sought.size[1] * wide, sought.size[2] * high


class _Crowd:
    """The objects on one table so far, and what distractors must keep possible."""

    def __init__(
        self,
        world: WorldFile,
        table: PlacedTable,
        name: str,
        objects: Sequence[PlacedThing],
        tags: Sequence[PlacedTag],
    ) -> None:
        assert world.distractors is not None
        self._rule, self._table, self._name = world.distractors, table, name
        self._goal = world.demands[0] if world.demands else None
        item = next((o for o in objects if o.name == world.sought), None)
        self._item = item
        self._objects = [disc_of(o) for o in objects if o.table == name and o is not item]
        self._tags = [tag for tag in tags if tag.table == name]

    @property
    def sought(self) -> Thing | None:
        """The object to bring."""
        return None if self._item is None else self._item.thing

    def takes(self, things: Sequence[PlacedThing]) -> bool:
        """Whether the last of these objects may stand at its place."""
        discs = [disc_of(thing) for thing in things]
        last, others = discs[-1], discs[:-1]
        if last.height > self._table.above - AIR:
            return False
        if any(gap(last, other) < self._rule.gap for other in (*others, *self._objects)):
            return False
        around = [*discs, *self._objects]
        return (
            self._leaves_item(last, around)
            and all(self._leaves_tag(tag, last, around) for tag in self._tags)
            and self._leaves_spot(around)
        )

    def _leaves_item(self, last: Disc, discs: Sequence[Disc]) -> bool:
        if self._item is None or self._item.table != self._name:
            return True
        item, side = disc_of(self._item), self._table.sides[0]
        return (
            gap(last, item) >= self._rule.gap_to_item
            and lane(item, discs, side)
            and seen_share(outline_points(item), discs, self._table, side, item) >= ITEM_SEEN
        )

    def _leaves_tag(self, tag: PlacedTag, last: Disc, discs: Sequence[Disc]) -> bool:
        disc, side = tag_disc(tag), self._table.sides[0]
        return (
            gap(last, disc) >= 0
            and seen_share(tag_points(tag.at, disc.radius), discs, self._table, side, disc) == 1
        )

    def _leaves_spot(self, discs: Sequence[Disc]) -> bool:
        """Whether a free spot for the item is left beside the marker."""
        goal, item = self._goal, self._item
        if goal is None or item is None or goal.on != self._name:
            return True
        marker = next((tag.at for tag in self._tags if tag.name == goal.beside), None)
        if marker is None:
            return True
        radius = item.thing.reach
        wanted = SetDown(radius, item.thing.height, goal.distance, self._table.sides[0])
        return bool(free_spots(wanted, self._table, discs, marker))


def disc_of(placed: PlacedThing) -> Disc:
    """The upright cylinder around a thing."""
    return Disc(placed.at.x, placed.at.y, placed.thing.reach, placed.thing.height)


def tag_corner(note: TagNote) -> float:
    """Distance from the centre of a tag or bundle to the farthest corner of a picture, m."""
    return max(
        float(np.linalg.norm(plate.bundle_from_tag.position))
        + picture_edge(plate.edge, note.family) / math.sqrt(2.0)
        for plate in note.plates
    )


def tag_disc(tag: PlacedTag) -> Disc:
    """The disc around the picture of a flat tag."""
    return Disc(tag.at.x, tag.at.y, tag_corner(tag.note), 0.0)
