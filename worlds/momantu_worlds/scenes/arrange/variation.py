"""Draw one episode's arrangement from its seed."""

from __future__ import annotations

import math

from momantu_bt.world import seeded
from momantu_worlds.scenes.arrange.floor import place_furniture, place_start, place_tables
from momantu_worlds.scenes.arrange.layout import Layout, Lighting
from momantu_worlds.scenes.arrange.tabletop import place_objects, place_tags, place_things
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.bodies import PointLight, SunLight

LAMP_HEIGHT = 2.4
"""Height of lamps, m, just below the walls' tops."""
USUAL_SUN = (0.5, 0.9)
"""Default range of a sun's brightness."""
SUN_TILT = (math.radians(20), math.radians(50))
"""Range of the sun's angle from straight down, rad."""


def vary(world: WorldFile, seed: int) -> Layout:
    """The layout of a seed; the same in every process.

    Raises:
        WorldError: the world leaves no room for the robot.
    """
    tables, shelves = place_tables(world, seed)
    start, believed = place_start(world, seed)
    tags = place_tags(world, seed, tables)
    objects = place_objects(world, seed, tables, tags)
    return Layout(
        seed=seed,
        tables=tables,
        objects=objects,
        tags=tags,
        things=place_things(world, seed, tables, objects, tags),
        pieces=place_furniture(world, seed, tables, shelves, start),
        start=start,
        believed_start=believed,
        light=place_light(world, seed),
    )


def place_light(world: WorldFile, seed: int) -> Lighting:
    """Draw the brightness of ambient light, sun and lamps, and the sun's direction."""
    draw, light = seeded(seed, "light"), world.light
    ambient = float(draw.uniform(*light.ambient))
    sun, warm = float(draw.uniform(*(light.sun or USUAL_SUN))), float(draw.uniform(0.9, 1.0))
    tilt, turn = float(draw.uniform(*SUN_TILT)), float(draw.uniform(-math.pi, math.pi))
    direction = (math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), -math.cos(tilt))
    suns = [SunLight(note.direction, note.color) for note in light.suns]
    if light.sun is not None or not suns:
        suns.insert(0, SunLight(direction, (sun, warm * sun, warm * sun)))
    lamps = []
    for x, y in light.lamps:
        strength = float(draw.uniform(*light.lamp))
        lamps.append(PointLight((x, y, LAMP_HEIGHT), (strength, strength, 0.92 * strength)))
    lamps += [PointLight(bulb.at, bulb.color) for bulb in light.bulbs]
    return Lighting(ambient=(ambient, ambient, ambient), suns=tuple(suns), lamps=tuple(lamps))
