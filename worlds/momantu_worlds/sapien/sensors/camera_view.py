"""A free camera for videos: it is not part of a robot and has no errors."""

from __future__ import annotations

from typing import Any

import numpy as np
import sapien
from numpy.typing import NDArray

from momantu_bt.geometry import Transform
from momantu_worlds.sapien.poses import pose_of
from momantu_worlds.sapien.sensors.camera import FAR, NEAR


class ViewCamera:
    """Takes pictures of a scene from any pose."""

    def __init__(
        self, scene: Any, width: int, height: int, horizontal_fov: float, *, far: float = FAR
    ) -> None:
        """width, height in px; horizontal_fov in rad; far: largest rendered distance, m."""
        self._scene = scene
        self._camera = sapien.render.RenderCameraComponent(width, height)
        self._camera.set_fovx(horizontal_fov, True)
        self._camera.near, self._camera.far = NEAR, far
        self._entity = sapien.Entity()
        self._entity.add_component(self._camera)
        scene.add_entity(self._entity)

    def take(self, map_from_camera: Transform) -> NDArray[np.uint8]:
        """A picture (h, w, 3) uint8; the camera looks along its x with z up."""
        self._entity.set_pose(pose_of(map_from_camera))
        self._scene.update_render()
        self._camera.take_picture()
        return np.asarray(self._camera.get_picture("Color")[..., :3])

    def met(self) -> NDArray[np.bool_]:
        """Pixels (h, w) of the last picture that show a body, not the background."""
        return np.asarray(self._camera.get_picture("Position")[..., 2] < 0.0)
