"""Markers: shapes that a skill draws for whoever watches the run, in a 3D viewer or on a map.

self.draw(Line("edge", corners, closed=True), Axes("tag", pose.transform, color="red"))

A marker never influences the run. It stays until a marker of the same name replaces it, or for
`seconds`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform

__all__ = ["COLORS", "Axes", "Box", "Grid", "Line", "Marker", "Points", "Text"]

Rgba: TypeAlias = tuple[float, float, float, float]

COLORS: dict[str, Rgba] = {
    "red": (0.85, 0.15, 0.15, 1.0),
    "green": (0.15, 0.65, 0.25, 1.0),
    "blue": (0.15, 0.40, 0.85, 1.0),
    "orange": (0.95, 0.55, 0.10, 1.0),
    "yellow": (0.90, 0.80, 0.10, 1.0),
    "purple": (0.55, 0.25, 0.75, 1.0),
    "white": (1.0, 1.0, 1.0, 1.0),
    "grey": (0.5, 0.5, 0.5, 1.0),
    "black": (0.0, 0.0, 0.0, 1.0),
}
"""Names of colours: red, green, blue and opacity, 0 to 1."""


@dataclass(frozen=True, eq=False)
class Marker:
    """What all markers have.

    name: a later marker of this name, drawn by the same node, replaces it. frame: of its
    coordinates, such as "odom", "map" or a link of the robot. color: a name of `COLORS`, or red,
    green, blue and opacity, 0 to 1. seconds: how long it stays; 0: to the end of the run.

    Raises:
        ValueError: an unknown colour, or coordinates of another shape.
    """

    name: str
    frame: str = field(default=ODOM, kw_only=True)
    color: str | Rgba = field(default="orange", kw_only=True)
    seconds: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        if isinstance(self.color, str):
            if self.color not in COLORS:
                raise ValueError(f"no color {self.color!r}; colors: {', '.join(COLORS)}")
        elif len(self.color) != 4 or not all(0.0 <= part <= 1.0 for part in self.color):
            raise ValueError(f"color {self.color!r}: expected four numbers from 0 to 1, or a name")
        if not self.seconds >= 0.0:
            raise ValueError(f"a marker for {self.seconds} s; expected 0 or more")

    @property
    def rgba(self) -> Rgba:
        """Red, green, blue and opacity, 0 to 1."""
        return COLORS[self.color] if isinstance(self.color, str) else self.color


@dataclass(frozen=True, eq=False)
class Points(Marker):
    """Points (n, 3), m. size: their diameter, m."""

    points: Array
    size: float = field(default=0.01, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "points", _rows(self.points, self.name))


@dataclass(frozen=True, eq=False)
class Line(Marker):
    """A line through points (n, 3), m. closed: back to the first one. width: m."""

    points: Array
    closed: bool = field(default=False, kw_only=True)
    width: float = field(default=0.01, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "points", _rows(self.points, self.name))


@dataclass(frozen=True, eq=False)
class Box(Marker):
    """A box. pose: of its centre, in the frame. size: its edges (x, y, z), m."""

    pose: Transform
    size: tuple[float, float, float]

    def __post_init__(self) -> None:
        super().__post_init__()
        _is_transform(self.pose, self.name)
        object.__setattr__(self, "size", _triple(self.size, self.name, "size"))


@dataclass(frozen=True, eq=False)
class Axes(Marker):
    """The axes of a pose in the frame: x red, y green, z blue. length: of each, m."""

    pose: Transform
    length: float = field(default=0.1, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        _is_transform(self.pose, self.name)


@dataclass(frozen=True, eq=False)
class Text(Marker):
    """A line of text. position: of its middle (x, y, z), m. height: of its letters, m."""

    position: tuple[float, float, float]
    text: str
    height: float = field(default=0.05, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "position", _triple(self.position, self.name, "position"))
        if not isinstance(self.text, str):
            raise ValueError(f"the text of marker {self.name!r} is {self.text!r}, expected a str")


@dataclass(frozen=True, eq=False)
class Grid(Marker):
    """Costs on the floor of its frame: values (rows, columns) from 0, free, to 1, blocked.

    origin: (x, y) of the outer corner of the first cell, m; columns go along x, rows along y.
    cell: size of a cell, m. A view in a browser shows grids; records do not keep them.
    """

    values: Array
    origin: tuple[float, float]
    cell: float

    def __post_init__(self) -> None:
        super().__post_init__()
        values = np.array(self.values, dtype=np.float32)
        if values.ndim != 2:
            raise ValueError(
                f"the grid of marker {self.name!r} has shape {values.shape}, expected two sides"
            )
        values.flags.writeable = False
        object.__setattr__(self, "values", values)


def _is_transform(pose: object, name: str) -> None:
    if not isinstance(pose, Transform):
        hint = "; write pose.transform" if isinstance(pose, Pose) else ""
        raise ValueError(f"the pose of marker {name!r} is {pose!r}, expected a Transform{hint}")


def _triple(numbers: object, name: str, what: str) -> tuple[float, float, float]:
    """Three numbers (x, y, z)."""
    try:
        x, y, z = np.asarray(numbers, dtype=np.float64).tolist()
    except (TypeError, ValueError):
        message = f"the {what} of marker {name!r} is {numbers!r}, expected three numbers (x, y, z)"
        raise ValueError(message) from None
    return x, y, z


def _rows(points: Array, name: str) -> Array:
    """A read-only copy, of shape (n, 3)."""
    rows = np.array(points, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"the points of marker {name!r} have shape {rows.shape}, expected (n, 3)")
    rows.flags.writeable = False
    return rows
