"""camera.misses_object: the next pictures that have the item in view do not show it."""

from __future__ import annotations

import numpy as np
import sapien

from momantu_bt.fault import Fault
from momantu_bt.geometry import Array
from momantu_worlds.sapien.faults.pictures import PictureCount, cameras, frames
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.geometry.support import UprightCylinder


class MissesObject:
    """Hides the item from the robot's cameras; it stays in the world."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """Parameters: frames, the number of pictures of the place that do not show it."""
        self._stage = stage
        self._cameras, self._frames = cameras(stage, fault), frames(fault)
        self._middle = np.array([0.0, 0.0, UprightCylinder(stage.item).height / 2])
        entity = stage.simulator.truth.entity(stage.goal.item)
        self._look = entity.find_component_by_type(sapien.render.RenderBodyComponent)
        self._count: PictureCount | None = None

    def begin(self) -> None:
        """Hide it from the next picture on."""
        for camera in self._cameras:
            camera.hidden.append(self._look)
        self._count = PictureCount(self._stage, self._frames, self._point, self.end)

    def end(self) -> None:
        """Show it again; this happens by itself after the given number of pictures."""
        if self._count is not None:
            self._count.stop()
            self._count = None
            for camera in self._cameras:
                camera.hidden.remove(self._look)

    def _point(self) -> Array:
        return self._stage.item_pose().apply(self._middle)
