"""The site that follows from a world file: surfaces and what hangs over them, places, objects."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass
from momantu_bt.world import Overhang, Site, Surface
from momantu_worlds.scenes.arrange.layout import PlacedTable
from momantu_worlds.scenes.arrange.surfaces import nominal_surfaces
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.plane import Rectangle, gap
from momantu_worlds.scenes.site.coverage import Column
from momantu_worlds.scenes.site.floor_plan import area_of, known_parts
from momantu_worlds.scenes.site.tags import told_tags

SIGMAS = 2.0
"""The largest error of the rough start pose, in standard deviations."""
LEAST = 0.10
"""m above a surface; lower solids stand on it, higher ones hang over it."""
MOST = 1.5
"""m above a surface; an arm that works on the surface may reach this high."""
SAME = 0.01
"""m; two tops are the same if their heights and their centres differ by less than this."""


def site_of(world: WorldFile, start: Pose2D) -> Site:
    """The site: nominal surfaces, places and object classes, and a rough start pose."""
    tops = nominal_surfaces(world)
    over = overhangs(world, tops)
    surfaces = {
        name: Surface(top.pose, top.size, top.height, top.sides, over[name], top.round)
        for name, top in tops.items()
    }
    notes = world.site
    begin = world.start
    return Site(
        name=world.name,
        start=start,
        start_sigma=(begin.belief_shift / SIGMAS, begin.belief_turn / SIGMAS),
        places=MappingProxyType({name: Pose2D(*pose) for name, pose in notes.places.items()}),
        surfaces=MappingProxyType(surfaces),
        objects=MappingProxyType(
            {name: ObjectClass(**sizes.model_dump()) for name, sizes in notes.objects.items()}
        ),
        tags=MappingProxyType(told_tags(world)),
        services=MappingProxyType(notes.services),
        area=None if world.site.map is not None else area_of(world),
        zones=MappingProxyType({name: note.zone for name, note in notes.zones.items()}),
    )


def overhangs(world: WorldFile, tops: Mapping[str, PlacedTable]) -> dict[str, tuple[Overhang, ...]]:
    """For each surface what hangs over it at its nominal place, the lowest first.

    Boards that are surfaces themselves are left out.
    """
    parts = [part for part in known_parts(world) if not _named(part, tops)]
    return {
        name: tuple(
            Overhang(part.base.pose, part.base.size, part.bottom, part.top)
            for part in sorted(parts, key=lambda part: part.bottom)
            if _hangs_over(part, top)
        )
        for name, top in tops.items()
    }


def _hangs_over(part: Column, top: PlacedTable) -> bool:
    if not top.height + LEAST <= part.bottom <= top.height + MOST:
        return False
    return gap(part.base, Rectangle(top.pose, top.size)) == 0.0


def _named(part: Column, tops: Mapping[str, PlacedTable]) -> bool:
    """Whether a part is the top of one of the surfaces."""
    return any(
        abs(part.top - top.height) < SAME and part.base.pose.distance_to(top.pose) < SAME
        for top in tops.values()
    )
