"""What skills draw, for viewers: `/markers`."""

from __future__ import annotations

import math
from functools import singledispatch

import numpy as np

from momantu_bt.engine.events import Events
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.outside import Drawn
from momantu_bt.geometry import Array, Transform
from momantu_bt.marker import COLORS, Axes, Box, Grid, Line, Marker, Points, Rgba, Text
from momantu_bt.record.channels.channel import stamp_of, time_text
from momantu_bt.record.channels.poses import pose_text
from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.viewer_schemas import SCENE

_STRIP, _LOOP, _PAIRS = 0, 1, 2
"""foxglove.LineType."""
_PARTS = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
_NOWHERE = pose_text(Transform())
_THIN = 0.1
"""Width of the lines of axes, as a share of their length."""


class Markers:
    """Writes an entity for each marker at the moment at which it is drawn."""

    def __init__(self, events: Events) -> None:
        self._drawn: list[Drawn] = []
        events.subscribe(Drawn, self._drawn.append)

    def write(self, run: Executor, file: McapFile) -> None:
        """Write the markers of this tick; of those with one name the last."""
        if not self._drawn:
            return
        now = run.context.now
        newest = {
            f"{leaf.index} {leaf.name}/{marker.name}": marker
            for leaf, markers in self._drawn
            for marker in markers
            if not isinstance(marker, Grid)  # too large to be kept for each of its changes
        }
        self._drawn.clear()
        if not newest:
            return
        entities = ",".join(_entity(name, marker, now) for name, marker in newest.items())
        channel = file.channel("/markers", "foxglove.SceneUpdate", SCENE)
        file.add(channel, stamp_of(now), f'{{"deletions":[],"entities":[{entities}]}}')


def _entity(name: str, marker: Marker, now: float) -> str:
    parts = dict.fromkeys(_PARTS, "")
    parts.update(_shape(marker))
    texts = ",".join(f'"{part}":[{text}]' for part, text in parts.items())
    return (
        f'{{"timestamp":{time_text(now)},"frame_id":{dumps(marker.frame)},"id":{dumps(name)},'
        f'"lifetime":{time_text(marker.seconds)},"frame_locked":true,"metadata":[],{texts}}}'
    )


@singledispatch
def _shape(marker: Marker) -> dict[str, str]:
    """The primitives of a marker, by their kind; a marker of another class has none."""
    return {}


@_shape.register
def _(marker: Points) -> dict[str, str]:
    size = _vector(np.full(3, marker.size))
    solids = (
        f'{{"pose":{pose_text(Transform(point))},"size":{size},"color":{_color(marker.rgba)}}}'
        for point in _drawable(marker.points)
    )
    return {"spheres": ",".join(solids)}


@_shape.register
def _(marker: Line) -> dict[str, str]:
    kind = _LOOP if marker.closed else _STRIP
    return {"lines": _line(kind, _drawable(marker.points), marker.width, marker.rgba)}


@_shape.register
def _(marker: Axes) -> dict[str, str]:
    ends = marker.pose.apply(marker.length * np.eye(3))
    points = np.array([each for end in ends for each in (marker.pose.position, end)])
    colors = [COLORS[name] for name in ("red", "green", "blue") for _ in range(2)]
    thick = _THIN * marker.length
    return {"lines": _line(_PAIRS, points, thick, marker.rgba, colors)} if _finite(points) else {}


@_shape.register
def _(marker: Box) -> dict[str, str]:
    size = np.array(marker.size, dtype=float)
    if not _finite(size) or not _finite(marker.pose.position):
        return {}
    solid = f'"pose":{pose_text(marker.pose)},"size":{_vector(size)}'
    return {"cubes": f'{{{solid},"color":{_color(marker.rgba)}}}'}


@_shape.register
def _(marker: Text) -> dict[str, str]:
    position = np.array(marker.position, dtype=float)
    if not _finite(position):
        return {}
    return {
        "texts": f'{{"pose":{pose_text(Transform(position))},"billboard":true,'
        f'"font_size":{marker.height!r},"scale_invariant":false,'
        f'"color":{_color(marker.rgba)},"text":{dumps(marker.text)}}}'
    }


def _line(
    kind: int, points: Array, width: float, color: Rgba, colors: list[Rgba] | None = None
) -> str:
    several = ",".join(map(_color, colors or []))
    return (
        f'{{"type":{kind},"pose":{_NOWHERE},"thickness":{width!r},"scale_invariant":false,'
        f'"points":[{",".join(map(_vector, points))}],"color":{_color(color)},'
        f'"colors":[{several}],"indices":[]}}'
    )


def _drawable(points: Array) -> Array:
    """The points without those that are no numbers, which viewers cannot read."""
    return np.asarray(points[np.isfinite(points).all(axis=1)])


def _finite(numbers: Array) -> bool:
    return math.isfinite(float(np.sum(numbers)))


def _vector(point: Array) -> str:
    x, y, z = point.tolist()
    return f'{{"x":{x:.5f},"y":{y:.5f},"z":{z:.5f}}}'


def _color(rgba: Rgba) -> str:
    r, g, b, a = rgba
    return f'{{"r":{r:g},"g":{g:g},"b":{b:g},"a":{a:g}}}'
