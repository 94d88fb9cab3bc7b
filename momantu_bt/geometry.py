"""Rigid transforms, planar poses and conversions between rotations.

Quaternions are unit quaternions `(w, x, y, z)` of right-handed rotations. Arrays of points are
`(..., 3)`. A transform named `map_from_base` turns coordinates in base into coordinates in map.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]


def wrap_angle(angle: float) -> float:
    """Wrap an angle, rad, into (-pi, pi]."""
    wrapped = math.fmod(angle + math.pi, 2.0 * math.pi)
    if wrapped <= 0.0:
        wrapped += 2.0 * math.pi
    return wrapped - math.pi


def _read_only(values: ArrayLike, size: int) -> Array:
    array = np.array(values, dtype=np.float64).reshape(size)
    array.setflags(write=False)
    return array


def matrix_from_quaternion(quaternion: ArrayLike) -> Array:
    """Rotation matrix (3, 3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = np.asarray(quaternion, dtype=np.float64).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_from_matrix(rotation: ArrayLike) -> Array:
    """Unit quaternion (w, x, y, z), w >= 0, of a rotation matrix (3, 3) (Shepperd's method)."""
    m = np.asarray(rotation, dtype=np.float64)
    trace = float(m[0, 0] + m[1, 1] + m[2, 2])
    choices = (trace, float(m[0, 0]), float(m[1, 1]), float(m[2, 2]))
    best = choices.index(max(choices))
    if best == 0:
        q = (1 + trace, m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1])
    elif best == 1:
        q = (m[2, 1] - m[1, 2], 1 + 2 * m[0, 0] - trace, m[0, 1] + m[1, 0], m[0, 2] + m[2, 0])
    elif best == 2:
        q = (m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], 1 + 2 * m[1, 1] - trace, m[1, 2] + m[2, 1])
    else:
        q = (m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 + 2 * m[2, 2] - trace)
    array = np.array([float(v) for v in q])
    array /= math.sqrt(float(array @ array))
    return array if array[0] >= 0 else -array


def rotation_between(start: Array, end: Array) -> Array:
    """The smallest rotation (3, 3) from one unit vector (3,) to another that is not opposite."""
    axis, cosine = np.cross(start, end), float(start @ end)
    cross = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + cosine))


def quaternion_from_axis_angle(axis: ArrayLike, angle: float) -> Array:
    """Unit quaternion of a rotation by `angle` rad about `axis` (3,) of any length but 0."""
    unit = np.asarray(axis, dtype=np.float64)
    unit = unit / math.sqrt(float(unit @ unit))
    return np.concatenate([[math.cos(angle / 2)], math.sin(angle / 2) * unit])


def quaternion_from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Unit quaternion of fixed-axis roll, pitch, yaw in rad, as URDF defines them."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def quaternion_product(left: ArrayLike, right: ArrayLike) -> Array:
    """Hamilton product: rotates by `right` first, then by `left`."""
    w1, x1, y1, z1 = np.asarray(left, dtype=np.float64).tolist()
    w2, x2, y2, z2 = np.asarray(right, dtype=np.float64).tolist()
    return np.array(
        [
            w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
            w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
            w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
            w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        ]
    )


@dataclass(frozen=True, slots=True, eq=False)
class Transform:
    """A rigid transform: position (3,) in metres and unit quaternion (4,), both read-only."""

    position: Array
    quaternion: Array

    def __init__(
        self, position: ArrayLike = (0.0, 0.0, 0.0), quaternion: ArrayLike = (1.0, 0.0, 0.0, 0.0)
    ) -> None:
        q = np.array(quaternion, dtype=np.float64).reshape(4)
        norm = math.sqrt(float(q @ q))
        if not norm > 1e-9:
            raise ValueError(f"quaternion {quaternion!r} has no length, expected unit (w, x, y, z)")
        q /= norm
        q.setflags(write=False)
        object.__setattr__(self, "position", _read_only(position, 3))
        object.__setattr__(self, "quaternion", q)

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Transform:
        """From a homogeneous matrix (4, 4)."""
        m = np.asarray(matrix, dtype=np.float64)
        return cls(m[:3, 3], quaternion_from_matrix(m[:3, :3]))

    @classmethod
    def from_rotation(cls, rotation: ArrayLike, position: ArrayLike = (0.0, 0.0, 0.0)) -> Transform:
        """From a rotation matrix (3, 3) and a position (3,)."""
        return cls(position, quaternion_from_matrix(rotation))

    @classmethod
    def from_rpy(cls, xyz: Sequence[float], rpy: Sequence[float]) -> Transform:
        """From URDF's `xyz` in metres and `rpy` in rad."""
        return cls(xyz, quaternion_from_rpy(rpy[0], rpy[1], rpy[2]))

    @property
    def rotation(self) -> Array:
        """Rotation matrix (3, 3)."""
        return matrix_from_quaternion(self.quaternion)

    @property
    def matrix(self) -> Array:
        """Homogeneous matrix (4, 4)."""
        m = np.eye(4)
        m[:3, :3] = self.rotation
        m[:3, 3] = self.position
        return m

    @property
    def rpy(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw about fixed axes, rad; at a pitch of +-90 degrees the roll is 0."""
        r = self.rotation
        level = math.hypot(r[0, 0], r[1, 0])
        pitch = math.atan2(-r[2, 0], level)
        if level < 1e-9:
            return 0.0, pitch, math.atan2(-r[0, 1], r[1, 1])
        return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])

    @property
    def yaw(self) -> float:
        """Heading of the x axis in the xy plane, rad."""
        r = self.rotation
        return math.atan2(float(r[1, 0]), float(r[0, 0]))

    def inverse(self) -> Transform:
        """The transform that undoes this one."""
        w, x, y, z = self.quaternion.tolist()
        return Transform(-(self.rotation.T @ self.position), (w, -x, -y, -z))

    def apply(self, points: ArrayLike) -> Array:
        """Transform points (..., 3) from the source frame to the target frame."""
        return np.asarray(np.asarray(points, dtype=np.float64) @ self.rotation.T + self.position)

    def __matmul__(self, other: Transform) -> Transform:
        """`a_from_b @ b_from_c` is `a_from_c`."""
        return Transform(
            self.rotation @ other.position + self.position,
            quaternion_product(self.quaternion, other.quaternion),
        )

    def angle_to(self, other: Transform) -> float:
        """Angle between the two rotations, rad in [0, pi]."""
        return 2.0 * math.acos(min(1.0, abs(float(self.quaternion @ other.quaternion))))

    def __eq__(self, other: object) -> bool:
        """Whether all numbers are equal exactly, without a tolerance."""
        if not isinstance(other, Transform):
            return NotImplemented
        return bool(
            np.array_equal(self.position, other.position)
            and np.array_equal(self.quaternion, other.quaternion)
        )

    def __hash__(self) -> int:
        return hash((self.position.tobytes(), self.quaternion.tobytes()))


_POSE_TEXT = "a pose: numbers x;y;yaw in m and rad, or x;y;z;qx;qy;qz;qw"


@dataclass(frozen=True, slots=True)
class Pose2D:
    """A pose on the floor: x, y in metres and yaw in rad, in a frame that the user states."""

    x: float = field(metadata={"unit": "m"})
    y: float = field(metadata={"unit": "m"})
    yaw: float = field(
        default=0.0, metadata={"unit": "rad", "least": -2 * math.pi, "most": 2 * math.pi}
    )

    @classmethod
    def from_text(cls, text: str) -> Pose2D:
        """A pose of the map, from numbers with `;` between them.

        `x;y`, `x;y;yaw`, `x;y;z;qx;qy;qz;qw`, or Nav2's `stamp;map;x;y;z;qx;qy;qz;qw`; m and rad.

        Raises:
            ValueError: the text is none of these; the message says what is wrong.
        """
        words = [word.strip() for word in text.split(";")]
        if len(words) == 9:
            if words[1] not in ("", "map"):
                raise ValueError(f"{text!r} is in the frame {words[1]!r}; expected map")
            del words[:2]
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            raise ValueError(f"{text!r} is not {_POSE_TEXT}") from None
        if len(numbers) not in (2, 3, 7) or not all(map(math.isfinite, numbers)):
            raise ValueError(f"{text!r} is not {_POSE_TEXT}")
        if len(numbers) < 7:
            return cls(*numbers)
        x, y, z, qx, qy, qz, qw = numbers
        return cls.from_transform(Transform((x, y, z), (qw, qx, qy, qz)))

    def transform(self, z: float = 0.0) -> Transform:
        """The pose as a rigid transform, at height z, m."""
        return Transform(
            (self.x, self.y, z), (math.cos(self.yaw / 2), 0.0, 0.0, math.sin(self.yaw / 2))
        )

    @classmethod
    def from_transform(cls, transform: Transform) -> Pose2D:
        """The projection of a transform onto the floor."""
        return cls(float(transform.position[0]), float(transform.position[1]), transform.yaw)

    def __matmul__(self, other: Pose2D) -> Pose2D:
        """`a_from_b @ b_from_c` is `a_from_c`."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(
            self.x + c * other.x - s * other.y,
            self.y + s * other.x + c * other.y,
            wrap_angle(self.yaw + other.yaw),
        )

    def inverse(self) -> Pose2D:
        """The planar transform that undoes this one."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(
            -(c * self.x + s * self.y), -(-s * self.x + c * self.y), wrap_angle(-self.yaw)
        )

    def apply(self, points: Array) -> Array:
        """Points (n, 2) of the pose's own frame, in the frame that it is in."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        x, y = points[:, 0], points[:, 1]
        return np.stack([self.x + c * x - s * y, self.y + s * x + c * y], axis=1)

    def rotate(self, vectors: Array) -> Array:
        """Vectors (n, 2) of the pose's own frame, in the frame that it is in."""
        return Pose2D(0.0, 0.0, self.yaw).apply(vectors)

    def distance_to(self, other: Pose2D) -> float:
        """Distance between the two positions, m."""
        return math.hypot(self.x - other.x, self.y - other.y)


Path: TypeAlias = tuple[Pose2D, ...]
"""Poses of the map, one after the other; x points along the path, at the end to the goal's side."""


def path_lengths(path: Sequence[Pose2D]) -> list[float]:
    """The length of a path from its start to each of its poses, m."""
    lengths = [0.0] if path else []
    for before, after in itertools.pairwise(path):
        lengths.append(lengths[-1] + before.distance_to(after))
    return lengths


def nearest_index(
    path: Sequence[Pose2D], pose: Pose2D, first: int = 0, within: float = math.inf
) -> int:
    """The index of the pose of a path that is nearest to `pose`; the path is not empty.

    It is searched from `first` on, as far as `within` m along the path.
    """
    best, way = first, 0.0
    for index in range(first + 1, len(path)):
        way += path[index - 1].distance_to(path[index])
        if way > within:
            break
        if path[index].distance_to(pose) < path[best].distance_to(pose):
            best = index
    return best


@dataclass(frozen=True, slots=True)
class Pose:
    """A transform `frame_from_object`, its frame's name and the time for which it holds.

    frame: "odom" for things that the robot will touch, "map" for places.
    stamp: time of the world's clock, s.
    """

    transform: Transform
    frame: str
    stamp: float

    @property
    def position(self) -> Array:
        """Position (3,) in `frame`, m."""
        return self.transform.position
