"""A subscriber that shows a run in a browser: the world, the tree, and what the robot believes."""

from __future__ import annotations

import numpy as np

from momantu_bt.engine.context import RunContext
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.outside import Drawn
from momantu_bt.engine.skills.actuators import SensorRead
from momantu_bt.failure import Failure
from momantu_bt.frames import MAP
from momantu_bt.geometry import Transform
from momantu_bt.marker import Box, Grid, Line, Marker, Points, Text
from momantu_bt.messages import DetectedObject, LaserScan
from momantu_bt.record.channels.objects import objects_in
from momantu_bt.record.film import FRAME_EVERY
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.world import Layer, MarkerView, TreeView, View

PATH = "path"
"""The name of markers that show where the robot means to drive."""
SCAN_COLOR = "red"
OBJECT_COLOR = (0.2, 0.6, 0.9, 0.35)
LABEL_ABOVE = 0.06
"""Height of an object's label above its top, m."""


class ViewObserver:
    """Keeps a browser's view up to date. run: whose markers and beliefs it shows, if the view can.

    stays: leave the view open when the run is over.
    """

    def __init__(self, view: View, run: Executor | None = None, *, stays: bool = False) -> None:
        self._view, self._stays = view, stays
        self._ticks = 0
        self._drawn: list[Drawn] = []
        self._scans: dict[str, LaserScan] = {}
        self._objects: dict[str, int] = {}
        self._until: dict[str, float] = {}
        if run is not None and isinstance(view, MarkerView):
            run.context.events.subscribe(Drawn, self._drawn.append)
            run.context.events.subscribe(SensorRead, self._read)

    def _read(self, event: SensorRead) -> None:
        if isinstance(event.reading, LaserScan):
            self._scans[event.sensor] = event.reading

    def ticked(self, run: Executor) -> None:
        """Show the current world, the tree, and what the robot believes."""
        self._ticks += 1
        due = self._ticks % FRAME_EVERY == 1
        view = self._view
        if isinstance(view, MarkerView):
            self._show_objects(view, run.context)
            if self._drawn or self._until:
                self._draw(view, run.context)
            if due:
                self._show_scans(view, run.context)
        if due:
            if isinstance(view, TreeView):
                root = run.built.root
                rest = "coming to rest" if run.settling else running_text(root)
                view.tell(f"{run.context.now:.1f} s  {rest}", tree_lines(root))
            view.update()

    def _draw(self, view: MarkerView, context: RunContext) -> None:
        for leaf, markers in self._drawn:
            for marker in markers:
                map_from_frame = _map_from(marker.frame, context)
                name = f"{leaf.index} {leaf.name}/{marker.name}"
                if map_from_frame is None:
                    continue
                view.draw(name, marker, map_from_frame, _layer(marker))
                self._until.pop(name, None)
                if marker.seconds:
                    self._until[name] = context.now + marker.seconds
        self._drawn.clear()
        for name in [name for name, until in self._until.items() if until < context.now]:
            view.erase(name)
            del self._until[name]

    def _show_scans(self, view: MarkerView, context: RunContext) -> None:
        """The newest scan of each laser, where the robot believed the laser to be."""
        for sensor, scan in self._scans.items():
            map_from_laser = _map_from(scan.frame, context, scan.stamp)
            if map_from_laser is not None:
                points = Points(sensor, hits(scan), size=0.04, color=SCAN_COLOR, frame=MAP)
                view.draw(f"scan/{sensor}", points, map_from_laser, Layer.SCAN)
        self._scans.clear()

    def _show_objects(self, view: MarkerView, context: RunContext) -> None:
        """The objects on the blackboard, each with its category."""
        for name, value in {cell.name: cell.value for cell, _ in context.writes}.items():
            objects = objects_in(value)
            for number in range(self._objects.pop(name, 0)):
                view.erase(f"object/{name}/{number}/box")
                view.erase(f"object/{name}/{number}/label")
            if objects:
                self._objects[name] = len(objects)
            for number, thing in enumerate(objects):
                map_from_frame = _map_from(thing.pose.frame, context)
                if map_from_frame is None:
                    continue
                for marker in _object_markers(thing):
                    where = f"object/{name}/{number}/{marker.name}"
                    view.draw(where, marker, map_from_frame, Layer.OBJECTS)

    def close(self) -> None:
        """Stop serving, unless it stays open."""
        if not self._stays:
            self._view.close()


def _layer(marker: Marker) -> Layer:
    if isinstance(marker, Grid):
        return Layer.COSTMAP
    return Layer.PATH if isinstance(marker, Line) and marker.name == PATH else Layer.MARKERS


def _object_markers(thing: DetectedObject) -> tuple[Marker, Marker]:
    """A box around an object, and its category above it."""
    pose, frame = thing.pose.transform, thing.pose.frame
    x, y, z = pose.position.tolist()
    above = (x, y, z + thing.size[2] / 2 + LABEL_ABOVE)
    return (
        Box("box", pose, thing.size, color=OBJECT_COLOR, frame=frame),
        Text("label", above, thing.category, frame=frame),
    )


def hits(scan: LaserScan) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The points (n, 3) that the beams met, in the laser's frame, m."""
    ranges = np.asarray(scan.ranges, dtype=np.float64)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    met = np.isfinite(ranges) & (ranges < scan.range_max) & (ranges > 0.0)
    ranges, angles = ranges[met], angles[met]
    return np.stack([ranges * np.cos(angles), ranges * np.sin(angles), 0.0 * ranges], axis=1)


def _map_from(frame: str, context: RunContext, stamp: float | None = None) -> Transform | None:
    """Where the robot believes a frame to be; None where it does not know."""
    if context.body is None:
        return None
    try:
        return context.body.frames.lookup(MAP, frame, stamp)
    except Failure:
        return None
