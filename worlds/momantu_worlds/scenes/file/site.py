"""The site of a world file."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from momantu_bt.descriptions.quantities import Size
from momantu_bt.descriptions.zones import MOST_ZONES, ZoneNote
from momantu_worlds.scenes.file.values import Name, Part, PlanarPose, Pose3D


class ObjectSizes(Part):
    """What the robot is told about a class of objects."""

    category: Name
    diameter: Size | None = None
    height: Size | None = None
    width: Size | None = None
    depth: Size | None = None


class ToldTag(Part):
    """A tag or bundle that the robot is told of.

    place: in the map, of its frame, whose x points right, y up and z out of the print; if omitted,
    where this file hangs it.
    """

    place: Pose3D | None = None


class SiteNotes(Part):
    """The site's own data, in addition to what follows from the other sections.

    map: map_server YAML of your own floor plan; if omitted, the map is drawn from this file.
    tags: tags of this file and of `tags_file` that the robot is told of, by name. tags_file: tags
    and bundles as tags.yaml of apriltag_ros has them; the robot is told of all of them. services:
    tunables of services and skills, by name; see `momantu_bt.descriptions.tunables`. zones: parts
    of the floor to keep out of, to drive slowly in, or to prefer, by name.
    """

    resolution: Annotated[Size, Field(ge=0.01, le=0.5)] = 0.05
    places: dict[Name, PlanarPose] = {}
    objects: dict[Name, ObjectSizes] = {}
    tags: dict[str, ToldTag] = {}
    tags_file: Annotated[str, Field(min_length=1, max_length=500)] | None = None
    services: dict[Name, dict[str, Any]] = {}
    zones: Annotated[dict[Name, ZoneNote], Field(max_length=MOST_ZONES)] = {}
    map: Annotated[str, Field(min_length=1, max_length=500)] | None = None
