"""The camera of a browser's view, which moves along with the robot."""

from __future__ import annotations

from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Pose2D

AWAY = (-2.4, -2.0, 3.6)
"""m from the robot: where a browser looks from at first, above the walls."""
FOCUS = 0.6
"""Height above the floor that it looks at, m."""
MOVED = 0.005
"""m; smaller motions of the robot do not move the camera."""


class Following:
    """Moves the cameras of all browsers by the way that the robot makes.

    A person can still turn, move and zoom the camera: only the robot's motion is added.
    """

    def __init__(self, server: Any, base: Pose2D) -> None:
        self._server = server
        self._at = _focus(base)
        self._aim()

    def move(self, base: Pose2D, *, follows: bool) -> None:
        """Follow the robot to where its base is now, if the person wants that."""
        way = _focus(base) - self._at
        if np.abs(way).max() < MOVED:
            return
        self._at = self._at + way
        self._aim()
        if follows:
            for client in self._server.get_clients().values():
                if client.camera.update_timestamp:  # 0 before the browser has told its camera
                    client.camera.position = client.camera.position + way

    def _aim(self) -> None:
        """Where a browser that comes now looks from."""
        self._server.initial_camera.position = self._at + np.array(AWAY)
        self._server.initial_camera.look_at = self._at


def _focus(base: Pose2D) -> Array:
    return np.array([base.x, base.y, FOCUS])
