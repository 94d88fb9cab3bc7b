"""What the robot is told: the site that follows from a world file."""

from __future__ import annotations

from pathlib import Path
from types import MappingProxyType

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass
from momantu_bt.world import Site, Surface
from momantu_worlds.scenes.world_file import WorldFile, pose2d

SIGMAS = 2.0
"""The farthest a rough start may be off counts as this many standard deviations."""


def site_of(world: WorldFile, start: Pose2D, map_file: Path, overhang_file: Path) -> Site:
    """The site: nominal tables, places and object classes, and a rough start pose."""
    surfaces = {
        name: Surface(table.pose, table.size[:2], table.size[2], table.sides)
        for name, table in world.tables.items()
    }
    notes = world.site
    begin = world.start
    return Site(
        name=world.name,
        map_file=map_file,
        overhang_file=overhang_file,
        start=start,
        start_sigma=(begin.belief_shift / SIGMAS, begin.belief_turn / SIGMAS),
        places=MappingProxyType({name: pose2d(pose) for name, pose in notes.places.items()}),
        surfaces=MappingProxyType(surfaces),
        objects=MappingProxyType(
            {name: ObjectClass(**sizes.model_dump()) for name, sizes in notes.objects.items()}
        ),
    )
