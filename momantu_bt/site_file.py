"""The site file beside a map: names of places and surfaces that a robot was taught, and zones."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from momantu_bt.descriptions.quantities import Angle, Length, Size
from momantu_bt.descriptions.reading import DescriptionError, Reading, read_text
from momantu_bt.descriptions.validation import checked
from momantu_bt.descriptions.zones import ZoneNote
from momantu_bt.geometry import Pose2D
from momantu_bt.world import Surface

PlanarPose: TypeAlias = tuple[Length, Length, Angle]
NAME = r"[a-z][a-z0-9_]*"
Name: TypeAlias = Annotated[str, Field(pattern=f"^{NAME}$", max_length=60)]

_HEAD = """\
# Names on the map beside this file. Poses are [x, y, yaw] in the map, in m and rad.
# start: where the robot stood when it began the map.
"""


class SiteFileError(DescriptionError):
    """A site file is wrong; the message lists every problem with its line and a caret."""

    what = "site"


class TaughtSurface(BaseModel):
    """A surface. centre: of its top; size: along x and y of `centre`; height: above the floor.

    sides: the directions from which the robot can approach it, in the surface's frame.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    centre: PlanarPose
    size: tuple[Size, Size]
    height: Size
    sides: Annotated[tuple[Angle, ...], Field(min_length=1, max_length=8)]
    round: bool = False

    @classmethod
    def of(cls, surface: Surface) -> TaughtSurface:
        """The entry of a surface."""
        at = surface.map_from_surface
        return cls(
            centre=(at.x, at.y, at.yaw),
            size=surface.size,
            height=surface.height,
            sides=surface.sides,
            round=surface.round,
        )

    def surface(self) -> Surface:
        """The surface of an entry."""
        return Surface(Pose2D(*self.centre), self.size, self.height, self.sides, round=self.round)


class Names(BaseModel):
    """A site file's content; all of it in the map's frame, m and rad."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    start: PlanarPose
    places: dict[Name, PlanarPose] = {}
    surfaces: dict[Name, TaughtSurface] = {}
    zones: dict[Name, ZoneNote] = {}

    @classmethod
    def of(
        cls, start: Pose2D, places: Mapping[str, Pose2D], surfaces: Mapping[str, Surface]
    ) -> Names:
        """The names that a run knows."""
        return cls(
            start=(start.x, start.y, start.yaw),
            places={name: (p.x, p.y, p.yaw) for name, p in places.items()},
            surfaces={name: TaughtSurface.of(surface) for name, surface in surfaces.items()},
        )

    def text(self) -> str:
        """The file's text, which reads back as the same."""
        lines = [f"start: {_row(self.start)}"]
        lines += ["places:"] if self.places else ["places: {}"]
        lines += [f"  {name}: {_row(pose)}" for name, pose in self.places.items()]
        lines += ["surfaces:"] if self.surfaces else ["surfaces: {}"]
        for name, surface in self.surfaces.items():
            lines += [
                f"  {name}:",
                f"    centre: {_row(surface.centre)}",
                f"    size: {_row(surface.size)}",
                f"    height: {surface.height:.4f}",
                f"    sides: {_row(surface.sides)}",
                *(["    round: true"] if surface.round else []),
            ]
        lines += ["zones:"] if self.zones else []
        for name, zone in self.zones.items():
            corners = ", ".join(_row(corner) for corner in zone.corners)
            lines += [f"  {name}:", f"    kind: {zone.kind}", f"    corners: [{corners}]"]
            lines += [] if zone.speed is None else [f"    speed: {zone.speed:.4f}"]
        return _HEAD + "\n".join(lines) + "\n"


def read_names(path: Path) -> Names:
    """Read a site file.

    Raises:
        SiteFileError: it cannot be read, or a value is wrong.
    """
    reading = Reading(path, read_text(path, SiteFileError), SiteFileError)
    return checked(reading, Names, SiteFileError)


def _row(numbers: tuple[float, ...]) -> str:
    return f"[{', '.join(f'{number:.4f}' for number in numbers)}]"
