"""Names that were taught while the map was made: where they lie moves with the scans about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names
from momantu_bt.world import Places, Site, Surface, Surfaces


@dataclass(frozen=True, slots=True)
class _Anchor:
    """A name. thing: where it lies with its scan at `map_from_scan`. scan: the scan's number."""

    thing: Pose2D | Surface
    scan: int
    map_from_scan: Pose2D
    scan_from_thing: Pose2D

    def at(self, poses: Sequence[Pose2D]) -> Pose2D | Surface:
        """The same with the scans at other poses."""
        if poses[self.scan] == self.map_from_scan:
            return self.thing
        there = poses[self.scan] @ self.scan_from_thing
        if isinstance(self.thing, Surface):
            return replace(self.thing, map_from_surface=there)
        return there


class Anchors:
    """Keeps each name of a run relative to the scan that was the newest when it was taught.

    A name that the site told before does not move: it is told in the map.
    """

    def __init__(self, site: Site) -> None:
        self._site = site
        self._held: dict[str, _Anchor] = {}
        self._told = self._things()

    def _things(self) -> dict[str, Pose2D | Surface]:
        return {**self._site.places, **self._site.surfaces}

    def note(self, poses: Sequence[Pose2D]) -> None:
        """Hold on to names that were taught or corrected since the last time.

        poses: `map_from_base` of all scans so far; call it before new scans change them.
        """
        if not poses:
            return
        for name, thing in self._things().items():
            held = self._held.get(name)
            if thing != (self._told.get(name) if held is None else held.thing):
                self._hold(name, thing, len(poses) - 1, poses)

    def hold_all(self, poses: Sequence[Pose2D]) -> None:
        """Hold on to every name at the scan that was taken nearest to it: they were read."""
        for name, thing in self._things().items():
            at = _pose(thing)
            nearest = min(range(len(poses)), key=lambda scan: (poses[scan].distance_to(at), scan))
            self._hold(name, thing, nearest, poses)

    def _hold(self, name: str, thing: Pose2D | Surface, scan: int, poses: Sequence[Pose2D]) -> None:
        scan_from_thing = poses[scan].inverse() @ _pose(thing)
        self._held[name] = _Anchor(thing, scan, poses[scan], scan_from_thing)

    def names(self, poses: Sequence[Pose2D]) -> Names:
        """What a map of so many scans at such poses calls things; it starts at the first scan."""
        moved = self._things()
        moved |= {n: held.at(poses) for n, held in self._held.items() if held.scan < len(poses)}
        places = {name: each for name, each in moved.items() if isinstance(each, Pose2D)}
        surfaces = {name: each for name, each in moved.items() if isinstance(each, Surface)}
        return Names.of(poses[0], places, surfaces)

    def move(self, poses: Sequence[Pose2D]) -> None:
        """Tell the run's site where its names are now that the scans are at other poses."""
        places, surfaces = self._site.places, self._site.surfaces
        for name, held in self._held.items():
            thing = held.at(poses)
            if thing == held.thing:
                continue
            if isinstance(thing, Surface):
                assert isinstance(surfaces, Surfaces)
                surfaces.teach(name, thing)
            else:
                assert isinstance(places, Places)
                places.teach(name, thing)
            self._held[name] = replace(held, thing=thing, map_from_scan=poses[held.scan])


def _pose(thing: Pose2D | Surface) -> Pose2D:
    return thing.map_from_surface if isinstance(thing, Surface) else thing
