"""What is known to hang over surfaces: a shelf's next board, a cupboard over a counter."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.world import Overhang
from momantu_worlds.scenes.arrange.layout import PlacedTable
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.plane import Rectangle, gap
from momantu_worlds.scenes.site.coverage import Standing
from momantu_worlds.scenes.site.floor_plan import known_parts

LEAST = 0.10
"""m above a surface from which on a solid hangs over it; what is lower stands on it."""
MOST = 1.5
"""m above a surface up to which an arm that works on it may reach."""
SAME = 0.01
"""m between the tops of two that are one."""


def overhangs(world: WorldFile, tops: Mapping[str, PlacedTable]) -> dict[str, tuple[Overhang, ...]]:
    """By surface what hangs over it where the file has it, the lowest first.

    Boards that are surfaces themselves are left out: they are told as such.
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


def _hangs_over(part: Standing, top: PlacedTable) -> bool:
    if not top.height + LEAST <= part.bottom <= top.height + MOST:
        return False
    return gap(part.base, Rectangle(top.pose, top.size)) == 0.0


def _named(part: Standing, tops: Mapping[str, PlacedTable]) -> bool:
    """Whether a part is the top of one of the surfaces."""
    return any(
        abs(part.top - top.height) < SAME and part.base.pose.distance_to(top.pose) < SAME
        for top in tops.values()
    )
