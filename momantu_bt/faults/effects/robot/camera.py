"""Faulty cameras: dark, wrong in depth, noisy, or turned on their mount."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from momantu_bt.faults.effects.robot.sensors import SensorLayer
from momantu_bt.geometry import Array, matrix_from_quaternion, quaternion_from_axis_angle
from momantu_bt.messages import CameraImage, frozen
from momantu_bt.robot import CameraSensor
from momantu_bt.world import seeded


class Dark(SensorLayer):
    """`camera.dark`: colours are scaled; a camera with a light of its own still measures depth."""

    sensor = CameraSensor

    def altered(self, sensor: str, reading: CameraImage) -> CameraImage:
        """The picture with dimmed colours."""
        dimmed = (reading.color * np.float32(self.number("gain"))).astype(np.uint8)
        return replace(reading, color=frozen(dimmed))


class Biased(SensorLayer):
    """`camera.biased`: depth times a factor, plus an offset; unmeasured pixels stay unmeasured."""

    sensor = CameraSensor

    def altered(self, sensor: str, reading: CameraImage) -> CameraImage:
        """The picture with other depths."""
        measured = reading.depth > 0.0
        depth = reading.depth * np.float32(self.number("scale")) + np.float32(self.number("offset"))
        depth = np.where(measured, np.maximum(depth, np.float32(0.0)), np.float32(0.0))
        return replace(reading, depth=frozen(depth))


class Noisier(SensorLayer):
    """`camera.noisier`: normal noise, its sigma in depth growing with the square of the distance.

    The seed, the sensor and the stamp determine the noise.
    """

    sensor = CameraSensor

    def altered(self, sensor: str, reading: CameraImage) -> CameraImage:
        """The picture with noise added."""
        random = seeded(self.seed, self.fault.name, sensor, reading.stamp)
        z = reading.depth
        noise = random.standard_normal(z.shape, dtype=np.float32)
        depth = z + np.float32(self.number("depth")) * z * z * noise
        depth = np.where(z > 0.0, np.maximum(depth, np.float32(0.0)), np.float32(0.0))
        grain = random.standard_normal(reading.color.shape, dtype=np.float32)
        color = np.rint(reading.color + np.float32(self.number("color")) * grain)
        return replace(
            reading,
            color=frozen(np.clip(color, 0, 255).astype(np.uint8)),
            depth=frozen(depth),
        )


class Shifted(SensorLayer):
    """`camera.shifted`: the picture of a turned camera that reports its old direction.

    The axis lies in the picture's plane, so that every turn moves what is seen. For a pure
    rotation each ray of the turned camera is a ray of the straight one (the infinite homography
    K R K^-1, Hartley and Zisserman, Multiple View Geometry, 2nd edition, section 8.4), so only
    what lies beyond the picture's edge is unknown; it stays black and unmeasured.
    """

    sensor = CameraSensor

    def altered(self, sensor: str, reading: CameraImage) -> CameraImage:
        """The picture as seen from the turned camera."""
        heading = float(seeded(self.seed, self.fault.name, sensor).uniform(0.0, 2.0 * math.pi))
        key = tuple(float(k) for k in reading.intrinsics.ravel())
        rows, columns, seen, scale = _turned(reading.depth.shape, key, heading, self.number("turn"))
        color = np.where(seen[..., None], reading.color[rows, columns], np.uint8(0))
        depth = np.where(seen, reading.depth[rows, columns] * scale, np.float32(0.0))
        return replace(
            reading, color=frozen(color), depth=frozen(np.maximum(depth, np.float32(0.0)))
        )


@lru_cache(maxsize=4)
def _turned(
    shape: tuple[int, int], intrinsics: tuple[float, ...], heading: float, turn: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_], NDArray[np.float32]]:
    """The position of each pixel of the turned camera in the straight camera's picture.

    Returns rows and columns (h, w), whether they lie in it, and the ratio turned / straight depth.
    """
    K: Array = np.array(intrinsics).reshape(3, 3)
    axis = (math.cos(heading), math.sin(heading), 0.0)
    straight_from_turned = matrix_from_quaternion(quaternion_from_axis_angle(axis, turn))
    v, u = np.mgrid[0 : shape[0], 0 : shape[1]]
    pixels = np.stack([u, v, np.ones_like(u)], axis=-1).astype(np.float64)
    rays = pixels @ (straight_from_turned @ np.linalg.inv(K)).T
    ahead = rays[..., 2] > 1e-6
    there = rays / np.where(ahead, rays[..., 2], 1.0)[..., None] @ K.T
    columns, rows = (np.rint(np.clip(there[..., i], -1e6, 1e6)).astype(np.intp) for i in (0, 1))
    seen = ahead & (columns >= 0) & (columns < shape[1]) & (rows >= 0) & (rows < shape[0])
    rows, columns = np.where(seen, rows, 0), np.where(seen, columns, 0)
    nearest = np.stack([columns, rows, np.ones_like(rows)], axis=-1) @ np.linalg.inv(K).T
    scale = (nearest @ straight_from_turned)[..., 2].astype(np.float32)
    return rows, columns, seen, scale
