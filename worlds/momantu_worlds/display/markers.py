"""Markers of skills in a browser's view."""

from __future__ import annotations

from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.marker import Axes, Box, Grid, Line, Marker, Points, Text

UPRIGHT = Transform((0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))
"""viser's images have y down and z into the picture; ours have y up and z out of it."""
ABOVE = 0.012
"""Height of a grid above its frame's floor, m."""
DENSEST = 0.75
"""Opacity of a blocked cell."""
THIN = 0.05
"""Radius of axes, as a share of their length."""


def drawn(scene: Any, name: str, marker: Marker, map_from_frame: Transform) -> Any:
    """Add a marker to viser's scene; returns its handle, or None where there is nothing to show."""
    color, opacity = tuple(round(255 * part) for part in marker.rgba[:3]), marker.rgba[3]
    if isinstance(marker, Points):
        points = _finite(map_from_frame.apply(marker.points))
        return scene.add_point_cloud(name, points, color, point_size=marker.size)
    if isinstance(marker, Line):
        points = _finite(map_from_frame.apply(marker.points))
        if marker.closed and len(points):
            points = np.vstack([points, points[:1]])
        pairs = np.stack([points[:-1], points[1:]], axis=1)
        return scene.add_line_segments(name, pairs, color, thickness=marker.width)
    if isinstance(marker, Box):
        pose = map_from_frame @ marker.pose
        return scene.add_box(
            name,
            color,
            marker.size,
            opacity=opacity,
            position=pose.position,
            wxyz=pose.quaternion,
        )
    if isinstance(marker, Axes):
        pose = map_from_frame @ marker.pose
        return scene.add_frame(
            name,
            axes_length=marker.length,
            axes_radius=THIN * marker.length,
            position=pose.position,
            wxyz=pose.quaternion,
        )
    if isinstance(marker, Text):
        return scene.add_label(name, marker.text, position=map_from_frame.apply(marker.position))
    if isinstance(marker, Grid) and marker.values.size:
        return _grid(scene, name, marker, map_from_frame)
    return None


def _grid(scene: Any, name: str, marker: Grid, map_from_frame: Transform) -> Any:
    """A picture on the floor: the more a cell costs, the less transparent it is."""
    rows, columns = marker.values.shape
    width, height = columns * marker.cell, rows * marker.cell
    x, y = marker.origin[0] + width / 2, marker.origin[1] + height / 2
    pose = map_from_frame @ Transform((x, y, ABOVE)) @ UPRIGHT
    costs = np.clip(np.nan_to_num(np.flipud(marker.values)), 0.0, 1.0)
    pixels = np.empty((rows, columns, 4), dtype=np.uint8)
    pixels[..., :3] = np.round(255 * np.array(marker.rgba[:3]))
    pixels[..., 3] = np.round(255 * DENSEST * marker.rgba[3] * costs)
    return scene.add_image(
        name,
        pixels,
        width,
        height,
        format="png",
        cast_shadow=False,
        receive_shadow=False,
        position=pose.position,
        wxyz=pose.quaternion,
    )


def _finite(points: Array) -> Array:
    return np.asarray(points[np.isfinite(points).all(axis=1)])
