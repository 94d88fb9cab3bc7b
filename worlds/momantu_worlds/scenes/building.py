"""Bodies of an episode, made from its layout."""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType

from momantu_bt.geometry import Transform
from momantu_bt.world import Site
from momantu_worlds.scenes.bodies import Body, Box, Episode, Gap, Goal, Part, Picture
from momantu_worlds.scenes.furniture import furniture
from momantu_worlds.scenes.layout import Layout
from momantu_worlds.scenes.objects import Thing
from momantu_worlds.scenes.parts import block
from momantu_worlds.scenes.tag36h11 import picture_edge, tag_picture
from momantu_worlds.scenes.world_file import WorldFile

FURNITURE_FRICTION = 0.6
"""Of painted wood and of most things on it; within the 0.4-0.8 that tables of physics give."""
TAG_LIFT = 0.0005
"""m; thickness of the paper, so that it is seen above the table's top."""
SLAB = 0.1
"""m; thickness of the floor."""


def build(world: WorldFile, layout: Layout, site: Site) -> Episode:
    """The episode of a layout, ready for a simulator."""
    return Episode(
        name=world.name,
        seed=layout.seed,
        bodies=tuple(bodies(world, layout)),
        start=layout.start,
        ambient=layout.light.ambient,
        suns=(layout.light.sun,),
        lamps=layout.light.lamps,
        site=site,
        goal=goal_of(world),
        doorways=MappingProxyType(
            {name: Gap(door.at, door.clear) for name, door in world.doorways.items()}
        ),
    )


def bodies(world: WorldFile, layout: Layout) -> Iterator[Body]:
    """Every body: floor, walls, tables, furniture, the item, the tag, loose things."""
    yield floor_body(world)
    yield from wall_bodies(world)
    yield from table_bodies(world, layout)
    for placed in layout.pieces:
        piece = placed.piece
        parts = furniture(piece.kind, piece.size, piece.color)
        pose = placed.pose.transform()
        yield Body(placed.name, piece.kind, pose, parts)
    yield item_body(world, layout)
    yield tag_body(world, layout)
    for thing in layout.things:
        map_from_thing = layout.tables[thing.table].map_from_top @ thing.at.transform()
        yield _loose(thing.name, thing.thing, map_from_thing, FURNITURE_FRICTION)


def floor_body(world: WorldFile) -> Body:
    """The slab whose top is z = 0; the simulator's own plane there is what is touched."""
    floor = world.floor
    slab = Box((*floor.size, SLAB))
    part = Part(slab, Transform((0, 0, -SLAB / 2)), floor.color, collision=False)
    pose = Transform((*floor.center, 0.0))
    return Body("floor", "floor", pose, (part,), friction=floor.friction)


def wall_bodies(world: WorldFile) -> Iterator[Body]:
    """One body for each wall piece."""
    walls = world.walls
    for piece in walls.pieces:
        size = (piece.length, walls.thickness, walls.height)
        part = block(size, (0, 0, walls.height / 2), walls.color)
        yield Body(f"wall_{piece.name}", "wall", walls.map_from_piece(piece).transform(), (part,))


def table_bodies(world: WorldFile, layout: Layout) -> Iterator[Body]:
    """The tables at the heights they have in this episode."""
    for name, table in world.tables.items():
        placed = layout.tables[name]
        parts = furniture(table.kind, (*placed.size, placed.height), table.color)
        yield Body(name, "table", placed.pose.transform(), parts, friction=FURNITURE_FRICTION)


def item_body(world: WorldFile, layout: Layout) -> Body:
    """What is brought."""
    item = world.item
    size = (2 * item.radius, 2 * item.radius, item.height)
    thing = Thing(item.kind, size, item.mass, item.color)
    map_from_item = layout.tables[item.on].map_from_top @ layout.item_at.transform()
    return _loose(item.name, thing, map_from_item, item.friction)


def tag_body(world: WorldFile, layout: Layout) -> Body:
    """The tag's paper: x to the right of its picture, y up in it, z out of it."""
    edge = picture_edge(world.tag.edge)
    part = Part(Picture((edge, edge), tag_picture(world.tag.id)), collision=False)
    map_from_top = layout.tables[world.tag.on].map_from_top
    return Body(world.tag.name, "tag", map_from_top @ layout.tag_at.transform(TAG_LIFT), (part,))


def goal_of(world: WorldFile) -> Goal:
    """The referee's demands."""
    goal = world.goal
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
    )


def _loose(name: str, thing: Thing, pose: Transform, friction: float) -> Body:
    return Body(
        name,
        thing.kind,
        pose,
        thing.parts(),
        static=False,
        mass=thing.mass,
        friction=friction,
    )
