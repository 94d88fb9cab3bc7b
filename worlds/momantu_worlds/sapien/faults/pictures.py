"""Counting the robot's own pictures of a place, for faults that last a number of pictures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Array
from momantu_bt.messages import CameraImage
from momantu_bt.robot import SensorReading
from momantu_worlds.sapien.faults.parameters import only, whole
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.sensors.camera import Camera

MOST_FRAMES = 1000


def cameras(stage: Stage, fault: Fault) -> list[Camera]:
    """The robot's cameras; FaultError if it has none."""
    found = [s for s in stage.simulator.robot.sensors.values() if isinstance(s, Camera)]
    if not found:
        raise FaultError(f"{fault.name}: the robot has no camera that could see wrongly")
    return found


def frames(fault: Fault) -> int:
    """The parameter `frames`, the only one; FaultError if it is wrong."""
    only(fault, "frames")
    return whole(fault, "frames", 1, MOST_FRAMES)


class PictureCount:
    """Calls `done` once so many of the robot's pictures had `point` () -> (3,) m, map, in view."""

    def __init__(
        self, stage: Stage, number: int, point: Callable[[], Array], done: Callable[[], None]
    ) -> None:
        self._stage, self._left, self._point, self._done = stage, number, point, done
        stage.simulator.robot.listeners.append(self._take)

    def stop(self) -> None:
        """Stop counting."""
        self._stage.simulator.robot.listeners.remove(self._take)

    def _take(self, reading: SensorReading) -> None:
        if isinstance(reading, CameraImage) and self._in_view(reading):
            self._left -= 1
            if self._left == 0:
                self._done()

    def _in_view(self, image: CameraImage) -> bool:
        camera = self._stage.simulator.truth.link(image.frame)
        x, y, z = (float(v) for v in camera.inverse().apply(self._point()))
        if z <= 0.0:
            return False
        u, v, _ = image.intrinsics @ np.array([x / z, y / z, 1.0])
        rows, columns = image.depth.shape
        return bool(0 <= u < columns and 0 <= v < rows)
