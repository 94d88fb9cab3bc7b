"""Build the bodies of an episode from its layout."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from types import MappingProxyType

from momantu_bt.descriptions.goal import GoalDemand
from momantu_bt.geometry import Transform
from momantu_bt.world import Site
from momantu_worlds.scenes.arrange.given_bodies import given_bodies
from momantu_worlds.scenes.arrange.layout import FRICTION, Layout, PlacedTag, PlacedThing
from momantu_worlds.scenes.arrange.mesh_files import mesh_parts
from momantu_worlds.scenes.arrange.obstacles import floor_extent
from momantu_worlds.scenes.arrange.surfaces import board_part, carriers
from momantu_worlds.scenes.catalogue.furniture import furniture, round_table
from momantu_worlds.scenes.catalogue.shelves import boarded
from momantu_worlds.scenes.catalogue.tags import picture_edge, tag_picture
from momantu_worlds.scenes.file.furniture import Piece, Table
from momantu_worlds.scenes.file.values import transform
from momantu_worlds.scenes.file.walls import LEAF
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.bodies import (
    Actor,
    Body,
    BodyTop,
    Box,
    Episode,
    Gap,
    Goal,
    Part,
    Picture,
)
from momantu_worlds.scenes.geometry.parts import Size3, block

TAG_LIFT = 0.0005
"""Thickness of the paper, m, so that it is rendered above its support."""
SLAB = 0.1
"""m; thickness of the floor."""
X_TO_Z = Transform.from_rpy((0.0, 0.0, 0.0), (math.pi / 2, 0.0, math.pi / 2))
"""Rotation of a tag on a wall: its normal (z) points along x."""


def build(world: WorldFile, layout: Layout, site: Site) -> Episode:
    """The episode of a layout, ready for a simulator.

    Raises:
        WorldError: a mesh file cannot be read.
    """
    return Episode(
        name=world.name,
        seed=layout.seed,
        bodies=tuple(bodies(world, layout)),
        start=layout.start,
        ambient=layout.light.ambient,
        suns=layout.light.suns,
        lamps=layout.light.lamps,
        site=site,
        goals=tuple(map(goal_of, world.demands)),
        goals_place=world.goal_place,
        doorways=MappingProxyType(
            {name: Gap(door.at, door.clear) for name, door in world.all_doorways.items()}
        ),
        actors=tuple(
            Actor(name, note.stops, note.speed, note.pause, note.group, note.color)
            for name, note in world.actors.items()
        ),
    )


def bodies(world: WorldFile, layout: Layout) -> Iterator[Body]:
    """Every body: floor, walls, tables, furniture, given bodies, objects, tags, distractors."""
    yield floor_body(world)
    yield from wall_bodies(world)
    yield from table_bodies(world, layout)
    shelves = carriers(world)
    for placed in layout.pieces:
        named = [world.tables[table].board for table in shelves.get(placed.name, ())]
        parts = piece_parts(world, placed.piece, without=[b for b in named if b is not None])
        category = placed.piece.kind or "furniture"
        yield Body(placed.name, category, placed.pose.transform(), parts)
    yield from given_bodies(world)
    for thing in layout.objects:
        yield _loose(thing, layout)
    for tag in layout.tags:
        yield tag_body(tag, layout)
    for thing in layout.things:
        yield _loose(thing, layout)


def floor_body(world: WorldFile) -> Body:
    """The visible floor with its top at z = 0; contacts are with the simulator's own plane."""
    center, size = floor_extent(world)
    slab = Box((*size, SLAB))
    part = Part(slab, Transform((0, 0, -SLAB / 2)), world.floor.color, collision=False)
    pose = Transform((*center, 0.0))
    return Body("floor", "floor", pose, (part,), friction=world.floor.friction)


def wall_bodies(world: WorldFile) -> Iterator[Body]:
    """One body for each piece of wall and each closed door."""
    for run in world.wall_runs:
        size = (run.length, run.thickness, run.top - run.bottom)
        part = block(size, (0, 0, (run.top + run.bottom) / 2), world.walls.color)
        yield Body(run.name, "wall", run.pose.transform(), (part,))
    for name, door, pose in world.door_leaves:
        part = block((door.width, LEAF, door.height), (0, 0, door.height / 2), door.color)
        yield Body(name, "door", pose.transform(), (part,))


def table_bodies(world: WorldFile, layout: Layout) -> Iterator[Body]:
    """Tables with their heights in this episode, and boards that are surfaces."""
    for name, table in world.tables.items():
        placed = layout.tables[name]
        if table.board_of is not None and table.board is not None:
            shelf = next(p for p in layout.pieces if p.name == table.board_of)
            part = board_part(shelf.piece, table.board - 1)
            yield Body(name, "board", shelf.pose.transform(), (part,), friction=FRICTION)
            continue
        parts = table_parts(world, table, (*placed.size, placed.height))
        top = None
        if table.mesh is not None or table.round:
            top = BodyTop(Transform((0.0, 0.0, placed.height)), placed.size, table.round)
        yield Body(name, "table", placed.pose.transform(), parts, friction=FRICTION, top=top)


def table_parts(world: WorldFile, table: Table, size: Size3) -> tuple[Part, ...]:
    """The parts of a table that is not a board, in its own frame."""
    if table.mesh is None and table.round:
        return round_table(size, table.color)
    if table.mesh is None:
        return furniture(table.kind, size, table.color)
    use = table.mesh.model_copy(update={"size": size})
    return mesh_parts(use, world.beside(use.file), standing=True, color=table.color)


def piece_parts(world: WorldFile, piece: Piece, without: Collection[int] = ()) -> tuple[Part, ...]:
    """The parts of a piece of furniture, in its frame. without: boards to omit, from 1."""
    if piece.mesh is not None:
        file = world.beside(piece.mesh.file)
        return mesh_parts(piece.mesh, file, standing=True, color=piece.color)
    if piece.boards:
        tops = (top for number, top in enumerate(piece.boards, 1) if number not in without)
        return boarded(str(piece.kind), piece.extent, piece.color, tops)
    assert piece.kind is not None
    return furniture(piece.kind, piece.size, piece.color)


def tag_body(tag: PlacedTag, layout: Layout) -> Body:
    """The paper of each tag: x to the right of its picture, y up in it, z out of it."""
    family, parts = tag.note.family, []
    for plate in tag.note.plates:
        edge = picture_edge(plate.edge, family)
        picture = Picture((edge, edge), tag_picture(plate.tag_id, family))
        parts.append(Part(picture, plate.bundle_from_tag, collision=False))
    return Body(tag.name, "tag", tag_pose(tag, layout), tuple(parts))


def tag_pose(tag: PlacedTag, layout: Layout) -> Transform:
    """`map_from_tag`."""
    if tag.table is not None:
        return layout.tables[tag.table].map_from_top @ tag.at.transform(TAG_LIFT)
    assert tag.note.hung is not None
    return map_from_hung(tag.note.hung)


def map_from_hung(hung: tuple[float, float, float, float, float, float]) -> Transform:
    """`map_from_tag` of a tag on a wall; hung: the pose of its middle, x where its face looks."""
    return transform(hung) @ X_TO_Z @ Transform((0.0, 0.0, TAG_LIFT))


def goal_of(goal: GoalDemand) -> Goal:
    """The referee's criteria for one demand."""
    return Goal(
        item=goal.item,
        support=goal.on,
        marker=goal.beside,
        max_tilt=goal.tilt,
        max_distance=goal.distance,
        still_for=goal.still,
        min_gripper_distance=goal.gripper,
        max_others_tilt=goal.others_tilt,
        max_others_shift=goal.others_shift,
        max_force=goal.force,
        lying=goal.lying,
    )


def _loose(placed: PlacedThing, layout: Layout) -> Body:
    map_from_thing = layout.tables[placed.table].map_from_top @ placed.at.transform()
    thing = placed.thing
    if thing.lying:
        map_from_thing = map_from_thing @ thing.rest
    return Body(
        placed.name,
        thing.kind,
        map_from_thing,
        thing.parts(),
        static=False,
        mass=thing.mass,
        friction=placed.friction,
    )
