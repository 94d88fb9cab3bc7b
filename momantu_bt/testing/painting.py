"""A depth camera without a renderer: rays against a few solids, with a real sensor's errors.

room = [Block((0.8, 1.2, 0.7), (1.0, 0.0, 0.35)), Round((1.0, 0.1, 0.7), 0.13, 0.035)]
robot = ScriptedRobot(readings={"camera": Painter(room)})
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, frozen
from momantu_bt.testing.robot import ScriptedRobot
from momantu_bt.world import seeded

FAR = 50.0
"""Length of rays that hit nothing, m."""
SUBPIXELS = 4
"""Rays per pixel and axis; their mean is the grey of a card."""
GAMMA = 2.2
"""A colour value is light to the power of 1 / GAMMA."""


@dataclass(frozen=True)
class Block:
    """A box with a level top. size and centre in m, yaw in rad."""

    size: tuple[float, float, float]
    centre: tuple[float, float, float]
    yaw: float = 0.0

    def hit(self, origin: Array, ways: Array) -> Array:
        """(n,) length at which rays from `origin` (3,) along `ways` (n, 3) meet it; FAR: never."""
        turn = Transform(self.centre, _about_z(self.yaw)).inverse()
        start, along = turn.apply(origin), ways @ turn.rotation.T
        along = np.where(np.abs(along) < 1e-12, 1e-12, along)
        half = np.array(self.size) / 2
        first, second = (-half - start) / along, (half - start) / along
        enter = np.minimum(first, second).max(axis=1)
        leave = np.maximum(first, second).min(axis=1)
        return np.where((enter <= leave) & (enter > 0), enter, FAR)


@dataclass(frozen=True)
class Round:
    """An upright cylinder or cone. foot: centre of its bottom; `upper` radius where it tapers.

    hollow: open at the top, with a floor at the bottom and walls without thickness.
    """

    foot: tuple[float, float, float]
    height: float
    radius: float
    upper: float | None = None
    hollow: bool = False

    def hit(self, origin: Array, ways: Array) -> Array:
        """As `Block.hit`."""
        start = origin - np.array(self.foot)
        top = self.radius if self.upper is None else self.upper
        best = self._wall(start, ways, (top - self.radius) / self.height)
        for level, radius in ((0.0, self.radius), (self.height, top)):
            if level > 0.0 and self.hollow:
                continue
            length = (level - start[2]) / np.where(ways[:, 2] == 0.0, 1e-12, ways[:, 2])
            flat = start[:2] + length[:, None] * ways[:, :2]
            on = (length > 0) & ((flat**2).sum(axis=1) <= radius**2)
            best = np.minimum(best, np.where(on, length, FAR))
        return best

    def _wall(self, start: Array, ways: Array, taper: float) -> Array:
        base, grow = self.radius + taper * start[2], taper * ways[:, 2]
        a = (ways[:, :2] ** 2).sum(axis=1) - grow**2
        b = ways[:, :2] @ start[:2] - base * grow
        c = float(start[:2] @ start[:2]) - base**2
        root = b * b - a * c
        safe, a = np.sqrt(np.maximum(root, 0.0)), np.where(np.abs(a) < 1e-12, 1e-12, a)
        best = np.full(len(ways), FAR)
        for length in ((-b - safe) / a, (-b + safe) / a):
            level = start[2] + length * ways[:, 2]
            on = (root >= 0) & (length > 0) & (level >= 0) & (level <= self.height)
            best = np.minimum(best, np.where(on, length, FAR))
        return best


@dataclass(frozen=True, eq=False)
class Card:
    """A picture without thickness. odom_from_card: z out of it, x to its right, y up.

    pixels: (n, n) 0 or 1, row 0 at the top. size: of its side, m.
    """

    odom_from_card: Transform
    size: float
    pixels: NDArray[np.uint8]

    def hit(self, origin: Array, ways: Array) -> Array:
        """As `Block.hit`."""
        start, along = self._own(origin, ways)
        length = -start[2] / np.where(along[:, 2] == 0.0, 1e-12, along[:, 2])
        flat = start[:2] + length[:, None] * along[:, :2]
        on = (length > 0) & (np.abs(flat) <= self.size / 2).all(axis=1)
        return np.where(on, length, FAR)

    def light(self, origin: Array, ways: Array) -> Array:
        """(n,) 0..1 where the rays' lines meet the card's plane."""
        start, along = self._own(origin, ways)
        flat = start[:2] - (start[2] / along[:, 2])[:, None] * along[:, :2]
        count = len(self.pixels)
        index = np.floor((flat / self.size + 0.5) * count).astype(int)
        column, row = np.clip(index[:, 0], 0, count - 1), np.clip(index[:, 1], 0, count - 1)
        return np.asarray(self.pixels[count - 1 - row, column], dtype=np.float64)

    def _own(self, origin: Array, ways: Array) -> tuple[Array, Array]:
        turn = self.odom_from_card.inverse()
        return turn.apply(origin), ways @ turn.rotation.T


Solid = Block | Round | Card


@dataclass(eq=False)
class Painter:
    """Draws what a scripted robot's first camera sees of `solids` (odom) and the floor.

    noise: sigma of depth z is noise times z2, 1/m. holes: share of pixels lost at depth edges.
    mounting: the camera's true pose in its own frame. `exact=True` turns all errors off.
    """

    solids: Sequence[Solid]
    seed: int = 0
    noise: float = 0.0015
    holes: float = 0.7
    mounting: Transform = field(default_factory=Transform)
    exact: bool = False

    def __call__(self, robot: ScriptedRobot) -> CameraImage:
        """The picture of now."""
        sensor = robot.description.camera()[1]
        base_from_camera = robot.description.kinematics().base_from_frame(
            sensor.frame, robot.joints
        )
        odom_from_camera = robot.base.transform() @ base_from_camera @ self.mounting
        focal = sensor.width / 2 / math.tan(sensor.horizontal_fov / 2)
        k = np.array(
            [
                [focal, 0.0, (sensor.width - 1) / 2],
                [0.0, focal, (sensor.height - 1) / 2],
                [0.0, 0.0, 1.0],
            ]
        )
        ways = _ways(k, sensor.width, sensor.height, odom_from_camera)
        origin = odom_from_camera.position
        depths = [solid.hit(origin, ways) for solid in self.solids]
        depths.append(np.where(ways[:, 2] < -1e-9, -origin[2] / ways[:, 2], FAR))
        which = np.argmin(depths, axis=0)
        size = (sensor.height, sensor.width)
        depth = np.min(depths, axis=0).reshape(size)
        color = self._color(which, origin, k, odom_from_camera, size)
        measured = depth if self.exact else self._measured(depth, robot.time)
        measured = np.where(
            (measured >= sensor.min_depth) & (measured <= sensor.max_depth), measured, 0.0
        )
        return CameraImage(
            robot.time,
            sensor.frame,
            np.asarray(frozen(color), dtype=np.uint8),
            np.asarray(frozen(measured.astype(np.float32)), dtype=np.float32),
            frozen(k),
        )

    def _color(
        self,
        which: NDArray[np.int64],
        origin: Array,
        k: Array,
        odom_from_camera: Transform,
        size: tuple[int, int],
    ) -> NDArray[np.uint8]:
        light = np.full(which.shape, 0.4)
        for index, solid in enumerate(self.solids):
            if isinstance(solid, Card):
                pixels = np.nonzero(which == index)[0]
                light[pixels] = _blended(solid, pixels, origin, k, odom_from_camera, size)
        values = np.round(255.0 * light ** (1.0 / GAMMA)).astype(np.uint8)
        return np.repeat(values.reshape(*size, 1), 3, axis=2)

    def _measured(self, depth: Array, stamp: float) -> Array:
        random = seeded(self.seed, "painter", stamp)
        noisy = depth + self.noise * depth**2 * random.standard_normal(depth.shape)
        edge = np.zeros(depth.shape, dtype=bool)
        for axis in (0, 1):
            step = np.abs(np.diff(depth, axis=axis)) > 0.04 * np.delete(depth, 0, axis=axis)
            edge |= np.insert(step, 0, False, axis=axis)
            edge |= np.insert(step, step.shape[axis], False, axis=axis)
        lost = random.random(depth.shape) < np.where(edge, self.holes, 0.002)
        return np.where(lost, 0.0, np.round(noisy, 3))


def _ways(k: Array, width: int, height: int, odom_from_camera: Transform) -> Array:
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(np.float64)
    return _ways_through(pixels, k, odom_from_camera)


def _ways_through(pixels: Array, k: Array, odom_from_camera: Transform) -> Array:
    """Directions (n, 3) in odom of unit depth, so that lengths along them are depths."""
    x = (pixels[:, 0] - k[0, 2]) / k[0, 0]
    y = (pixels[:, 1] - k[1, 2]) / k[1, 1]
    optical = np.column_stack([x, y, np.ones(len(pixels))])
    return np.asarray(optical @ odom_from_camera.rotation.T)


def _blended(
    card: Card,
    pixels: NDArray[np.int64],
    origin: Array,
    k: Array,
    odom_from_camera: Transform,
    size: tuple[int, int],
) -> Array:
    rows, columns = np.divmod(pixels, size[1])
    total = np.zeros(len(pixels))
    offsets = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
    for down in offsets:
        for right in offsets:
            spot = np.column_stack([columns + right, rows + down])
            total += card.light(origin, _ways_through(spot, k, odom_from_camera))
    return np.asarray(0.03 + 0.9 * total / SUBPIXELS**2)


def _about_z(yaw: float) -> tuple[float, float, float, float]:
    return (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
