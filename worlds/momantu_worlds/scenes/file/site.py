"""The site of a world file."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from momantu_bt.descriptions.quantities import Size
from momantu_worlds.scenes.file.values import Name, Part, PlanarPose


class ObjectSizes(Part):
    """What the robot is told about a class of objects."""

    category: Name
    diameter: Size | None = None
    height: Size | None = None
    width: Size | None = None
    depth: Size | None = None


class SiteNotes(Part):
    """The site's own data, in addition to what follows from the other sections.

    map: map_server YAML of your own floor plan; if omitted, the map is drawn from this file.
    services: tunables of services and skills, by name; see `momantu_bt.descriptions.tunables`.
    """

    resolution: Annotated[Size, Field(ge=0.01, le=0.5)] = 0.05
    places: dict[Name, PlanarPose] = {}
    objects: dict[Name, ObjectSizes] = {}
    services: dict[Name, dict[str, Any]] = {}
    map: Annotated[str, Field(min_length=1, max_length=500)] | None = None
