"""AprilTags that a robot is told of: families, single tags and bundles, and their places.

A tag's frame has its origin at the tag's centre, x to the right and y up on the print, and z out of
it. The edge of a tag is the border between its black and its white square: the outside of the black
square in the classic families.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

import numpy as np

from momantu_bt.geometry import Array, Transform

TagFamily: TypeAlias = Literal[
    "tag36h11",
    "tag25h9",
    "tag16h5",
    "tagStandard41h12",
    "tagStandard52h13",
    "tagCircle21h7",
    "tagCircle49h12",
    "tagCustom48h12",
]
"""Families of AprilTag 3, as apriltag_ros names them."""
FAMILIES: tuple[TagFamily, ...] = get_args(TagFamily)
USUAL_FAMILY: TagFamily = "tag36h11"
UNIT_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
"""A tag's corners in its frame, in edge lengths: lower left, lower right, upper right, upper left,
as the AprilTag library orders them."""


@dataclass(frozen=True, slots=True)
class TagPlate:
    """One tag of a bundle: its id, its edge in m, and where it is in the bundle's frame."""

    tag_id: int
    edge: float
    bundle_from_tag: Transform = field(default_factory=Transform)

    def corners(self) -> Array:
        """Its corners (4, 3) in the bundle's frame, m."""
        flat = np.column_stack([UNIT_CORNERS * self.edge, np.zeros(4)])
        return self.bundle_from_tag.apply(flat)


@dataclass(frozen=True, slots=True)
class TagBundle:
    """Tags of one family that are fixed to each other; a single tag is a bundle of one.

    map_from_bundle: where it is in the map; None if that is not known.
    """

    family: TagFamily
    plates: tuple[TagPlate, ...]
    map_from_bundle: Transform | None = None

    @property
    def ids(self) -> tuple[int, ...]:
        """The ids of its tags, in their order."""
        return tuple(plate.tag_id for plate in self.plates)


def single_tag(tag_id: int, edge: float, family: TagFamily = USUAL_FAMILY) -> TagBundle:
    """One tag as a bundle."""
    return TagBundle(family, (TagPlate(tag_id, edge),))
