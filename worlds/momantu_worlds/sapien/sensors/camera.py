"""The RGB-D camera: rendered on request, with the errors of a structured-light sensor."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import sapien
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.lazy import lazily
from momantu_bt.messages import CameraImage, frozen
from momantu_bt.robot import CameraSensor
from momantu_bt.world import seeded
from momantu_worlds.sapien.config import CameraErrors
from momantu_worlds.sapien.poses import pose_of, transform_of
from momantu_worlds.sapien.sensors.culling import Culling
from momantu_worlds.sapien.sensors.exposure import expose, metered, well_lit

with lazily():
    import cv2

NEAR, FAR = 0.05, 30.0
"""Range of the renderer, m. Colour is rendered farther than depth is measured."""
OPTICAL_FROM_SAPIEN = Transform.from_rotation(
    np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
)
"""SAPIEN's camera looks along x with z up; an optical frame looks along z with y down."""


class Camera:
    """Takes pictures from the link's true pose, plus a constant mounting error.

    hidden: render components that it does not see.
    """

    def __init__(
        self,
        scene: Any,
        link: Any,
        name: str,
        sensor: CameraSensor,
        seed: int,
        errors: CameraErrors,
        own_links: list[Any],
    ) -> None:
        self._scene, self._link, self._name = scene, link, name
        self._sensor, self._seed, self._errors = sensor, seed, errors
        self.link_from_camera = _mounting(seeded(seed, name, "mounting"), errors)
        self._camera, self._entity = _component(sensor)
        self.culling = Culling(own_links, sensor)
        self.hidden: list[Any] = []
        self.intrinsics = _intrinsics(sensor)
        scene.add_entity(self._entity)

    def read(self, stamp: float) -> CameraImage:
        """Take a picture now; runs the renderer."""
        truth = transform_of(self._link.entity_pose) @ self.link_from_camera
        self._entity.set_pose(pose_of(truth @ OPTICAL_FROM_SAPIEN))
        unseen = [*self.culling.outside(truth), *self.hidden]
        for body in unseen:
            body.disable()
        self._scene.update_render()
        self._camera.take_picture()
        # the renderer draws in a thread of its own: meanwhile the noise is drawn
        random = seeded(self._seed, self._name, stamp)
        noise = draw_noise(random, self._sensor.height, self._sensor.width)
        color = self._exposed(self._camera.get_picture("Color"), random)
        for body in unseen:
            body.enable()
        depth = -self._camera.get_picture("Position")[..., 2]
        return CameraImage(
            stamp,
            self._sensor.frame,
            frozen(noisy_color(color, noise, self._errors)),
            frozen(noisy_depth(depth, noise, self._sensor, self._errors)),
            self.intrinsics,
        )

    def _exposed(self, color: NDArray[np.uint8], random: np.random.Generator) -> NDArray[np.uint8]:
        """The colours (h, w, 4) as they are in good light, else with the exposure chosen anew."""
        if well_lit(color):
            return color
        radiance = self._camera.get_picture("Radiance")[..., :3]
        return expose(radiance, metered(radiance, self._sensor.exposure), random)

    def exact_depth(self) -> NDArray[np.float32]:
        """Depth (h, w) of the last picture without errors, m; 0 where there is no surface."""
        return np.asarray(-self._camera.get_picture("Position")[..., 2], dtype=np.float32)

    def bodies(self) -> NDArray[np.int32]:
        """`per_scene_id` of the entity at each pixel (h, w) of the last picture; 0 without one."""
        position = self._camera.get_picture("Position")
        seen = position[..., 2] < 0.0
        return np.where(seen, np.rint(position[..., 0]), 0).astype(np.int32)


class Noise(NamedTuple):
    """Random numbers of one picture.

    color: (h, w, 3) uniform bytes. depth: (h, w) standard normal. lost: (h, w) uniform in 0..1.
    """

    color: NDArray[np.uint8]
    depth: NDArray[np.float32]
    lost: NDArray[np.float32]


def draw_noise(random: np.random.Generator, height: int, width: int) -> Noise:
    """Draw the random numbers of one picture; height, width: px."""
    color = np.frombuffer(random.bytes(3 * height * width), dtype=np.uint8)
    depth = random.standard_normal((height, width), dtype=np.float32)
    lost = random.random((height, width), dtype=np.float32)
    return Noise(color.reshape(height, width, 3), depth, lost)


def noisy_color(color: NDArray[np.uint8], noise: Noise, errors: CameraErrors) -> NDArray[np.uint8]:
    """Colour (h, w, 3) with uniform noise of the configured sigma, grey levels.

    color: (h, w, 3 or 4).
    """
    span = round(errors.color_noise * math.sqrt(3.0))
    levels = (np.arange(256) % (2 * span + 1) - span).astype(np.int16)
    exact = cv2.cvtColor(color, cv2.COLOR_RGBA2RGB) if color.shape[2] == 4 else color
    noisy = cv2.add(exact, cv2.LUT(noise.color, levels), dtype=cv2.CV_8U)
    return np.asarray(noisy, dtype=np.uint8)


def noisy_depth(
    depth: NDArray[Any], noise: Noise, sensor: CameraSensor, errors: CameraErrors
) -> NDArray[np.float32]:
    """Depth (h, w) float32 with the errors of a structured-light camera.

    Noise grows with the square of the distance. Pixels at depth edges, out of range, and some
    random ones are 0.
    """
    z = np.asarray(depth, dtype=np.float32)
    lost_share = np.where(_edges(z, errors.edge_jump), errors.edge_hole, errors.drop_out)
    sigma = errors.depth_noise if sensor.depth_noise is None else sensor.depth_noise
    measured = np.float32(sigma) * z
    measured *= z
    measured *= noise.depth
    measured += z
    measured /= np.float32(errors.depth_quantum)
    np.rint(measured, out=measured)
    measured *= np.float32(errors.depth_quantum)
    valid = (z > 0) & (measured >= sensor.min_depth) & (measured <= sensor.max_depth)
    valid &= noise.lost >= lost_share
    measured[~valid] = 0.0
    return measured


def _edges(z: NDArray[np.float32], jump: float) -> NDArray[np.bool_]:
    """Pixels beside a depth step of more than `jump` times their depth."""
    limit = np.float32(jump) * z
    edges = np.zeros(z.shape, dtype=bool)
    across = np.abs(np.diff(z, axis=1)) > np.minimum(limit[:, 1:], limit[:, :-1])
    down = np.abs(np.diff(z, axis=0)) > np.minimum(limit[1:], limit[:-1])
    edges[:, 1:] |= across
    edges[:, :-1] |= across
    edges[1:] |= down
    edges[:-1] |= down
    return edges


def _mounting(random: np.random.Generator, errors: CameraErrors) -> Transform:
    shift = errors.mounting_position * random.standard_normal(3)
    turn = errors.mounting_angle * random.standard_normal(3)
    angle = float(np.linalg.norm(turn))
    if angle == 0.0:
        return Transform(shift)
    return Transform(shift, quaternion_from_axis_angle(turn, angle))


def _component(sensor: CameraSensor) -> tuple[Any, Any]:
    camera = sapien.render.RenderCameraComponent(sensor.width, sensor.height)
    camera.set_fovx(sensor.horizontal_fov, True)
    camera.near, camera.far = NEAR, FAR
    entity = sapien.Entity()
    entity.add_component(camera)
    return camera, entity


def _intrinsics(sensor: CameraSensor) -> Array:
    """Pinhole matrix (3, 3) for pixel centres at whole numbers."""
    focal = sensor.width / 2 / math.tan(sensor.horizontal_fov / 2)
    matrix = np.array(
        [
            [focal, 0.0, (sensor.width - 1) / 2],
            [0.0, focal, (sensor.height - 1) / 2],
            [0.0, 0.0, 1.0],
        ]
    )
    return np.asarray(frozen(matrix))
