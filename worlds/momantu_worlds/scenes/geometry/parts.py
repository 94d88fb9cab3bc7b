"""Shorthands for the parts that furniture and objects are made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.geometry.bodies import Box, Color, Cylinder, Part

Size3: TypeAlias = tuple[float, float, float]
"""Extents along x, y and z, m."""


def block(
    size: Sequence[float], center: Sequence[float], color: Color, *, yaw: float = 0.0
) -> Part:
    """A cuboid of full edge lengths `size` (3,) around `center` (3,), turned by `yaw` rad."""
    return Part(
        Box((float(size[0]), float(size[1]), float(size[2]))),
        Transform.from_rpy(center, (0.0, 0.0, yaw)),
        color,
    )


def column(
    radius: float, bottom: float, top: float, color: Color, x: float = 0, y: float = 0
) -> Part:
    """An upright cylinder between two heights, m."""
    return Part(Cylinder(radius, top - bottom), Transform((x, y, (top + bottom) / 2)), color)


def shade(color: Color, factor: float) -> Color:
    """The colour made darker (factor < 1) or lighter, kept within 0..1."""
    red, green, blue = (min(1.0, max(0.0, channel * factor)) for channel in color)
    return red, green, blue
