"""Invented robots that are not as their descriptions say, and what they measure of tags."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from momantu_skills.manipulation.model.batched import BatchedChain

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.robot import CameraSensor, RobotDescription

LENS = np.array([554.0, 554.0, 319.5, 239.5])
SIZE = (640, 480)
EDGE = 0.06
HAND_TAG = 7
UNIT = np.array([[-0.5, -0.5, 0, 0], [0.5, -0.5, 0, 0], [0.5, 0.5, 0, 0], [-0.5, 0.5, 0, 0]])


@dataclass
class Bent:
    """What is wrong.

    zeros: true minus reported. turn: of the camera, rad. wheels: left and right, wider: track,
    lens: focal length, each the true one over the believed one.
    """

    zeros: dict[str, float] = field(default_factory=dict)
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    wheels: tuple[float, float] = (1.0, 1.0)
    wider: float = 1.0
    lens: float = 1.0
    track: float = 0.3748


class Measuring:
    """Poses a bent robot before tags and writes down what it measures."""

    def __init__(
        self,
        robot: RobotDescription,
        bent: Bent,
        seed: int,
        noise: float = 0.2,
        stands: int = 4,
        there_and_back: float | None = None,
    ) -> None:
        """there_and_back: m from stand to stand, ahead and back in turn; None: 10 cm ahead.

        The base turns by 0.6 rad on each such way, by 0.3 rad if it is None.
        """
        self.robot, self.bent, self.noise = robot, bent, noise
        self.random = np.random.default_rng(seed)
        self.name, camera = robot.camera()
        assert isinstance(camera, CameraSensor)
        self.camera = BatchedChain(robot, camera.frame)
        self.hand = BatchedChain(robot, robot.hand.frame)
        self.joints = tuple(dict.fromkeys([*self.camera.names, *self.hand.names]))
        self.hand_from_tag = Transform.from_rpy((0.02, 0.01, 0.05), (0.1, -0.4, 0.3)).matrix
        self.stands = stands
        self.there_and_back = there_and_back

    def positions(self, count: int, base_from_tag: Array | None = None) -> Array:
        """Reported postures (count, J) in which the camera sees a tag (4, 4), else the hand's."""
        limits = [self.robot.joint_limits[name] for name in self.joints]
        low = np.array([-np.pi if each.lower is None else each.lower for each in limits])
        high = np.array([np.pi if each.upper is None else each.upper for each in limits])
        found: list[Array] = []
        while len(found) < count:
            tried = self.random.uniform(low, high, (4000, len(low)))
            there = self.hand_tag(tried) if base_from_tag is None else base_from_tag[None]
            corners, points, facing = self.seen(tried, there)
            good = _inside(corners).all(1) & (points[..., 2] > 0.3).all(1) & (facing > 0.5)
            found += list(tried[good & (points[..., 2] < 1.2).all(1)])
        return np.array(found[:count])

    def true(self, positions: Array) -> Array:
        """The true positions of the joints at reported ones."""
        return positions + [self.bent.zeros.get(name, 0.0) for name in self.joints]

    def hand_tag(self, positions: Array) -> Array:
        """base_from_tag (n, 4, 4) of the tag on the hand."""
        at = [self.joints.index(name) for name in self.hand.names]
        return self.hand.matrices(self.true(positions)[:, at]) @ self.hand_from_tag

    def base_from_camera(self, positions: Array) -> Array:
        """The true pose (n, 4, 4) of the camera."""
        at = [self.joints.index(name) for name in self.camera.names]
        angle = float(np.linalg.norm(self.bent.turn))
        turn = np.eye(4)
        if angle:
            turn = Transform((0, 0, 0), quaternion_from_axis_angle(self.bent.turn, angle)).matrix
        return self.camera.matrices(self.true(positions)[:, at]) @ turn

    def seen(self, positions: Array, base_from_tag: Array) -> tuple[Array, Array, Array]:
        """Corners (n, 4, 2) px, points (n, 4, 3) m in the camera, and how much the tag faces it."""
        camera_from_tag = np.linalg.inv(self.base_from_camera(positions)) @ base_from_tag
        model = UNIT * EDGE + [0, 0, 0, 1]
        points = (camera_from_tag[:, None] @ model[None, :, :, None])[..., :3, 0]
        focal = LENS[:2] * self.bent.lens
        corners = focal * points[..., :2] / np.maximum(points[..., 2:], 1e-3) + LENS[2:]
        normal, middle = camera_from_tag[:, :3, 2], camera_from_tag[:, :3, 3]
        facing = -(normal * middle).sum(1) / np.linalg.norm(middle, axis=1)
        return corners, points, facing

    def rows(self, views: int, world_tags: int = 4) -> list[dict[str, object]]:
        """Lines of a file: stands in a row, postures at each, with steps of odometry between."""
        tags = self._around(world_tags)
        true, told = np.eye(3), np.zeros(3)
        made: list[dict[str, object]] = []
        each = -(-views // self.stands)
        for stand in range(self.stands):
            if stand:
                way, turn = self._step(stand)
                for _ in range(5):
                    true = true @ _planar(self._driven(way, turn))
                    told = _pose(_planar(told) @ _planar(_arc(way, turn)))
                    stamp = float(len(made))
                    made.append({"stamp": stamp, "odometry": told.tolist()})
            for positions in self._postures(each, true, tags):
                made.append(self._row(float(len(made)), positions, true, told, tags))
        return made

    def _step(self, stand: int) -> tuple[float, float]:
        """One of five steps of odometry to a stand: m ahead, rad."""
        if self.there_and_back is None:
            return 0.02, 0.06 if stand % 2 else -0.06
        ahead, left = stand % 2, stand % 4 in (1, 2)
        return 0.2 * self.there_and_back * (1 if ahead else -1), 0.12 if left else -0.12

    def _postures(self, count: int, true: Array, tags: dict[int, Array]) -> Array:
        """Postures at one stand: looking at the hand, or with a camera on the arm at the tags."""
        if not self.robot.eye_in_hand:
            return self.positions(count)
        each = -(-count // len(tags))
        places = [_lifted(np.linalg.inv(true)) @ pose for pose in tags.values()]
        return np.concatenate([self.positions(each, place) for place in places])[:count]

    def _driven(self, way: float, turn: float) -> Array:
        """The true step where odometry says `way` and `turn`."""
        left, right = self.bent.wheels
        track = self.bent.track
        a, b = (way - 0.5 * turn * track) * left, (way + 0.5 * turn * track) * right
        return _arc((a + b) / 2, (b - a) / (track * self.bent.wider))

    def _around(self, count: int) -> dict[int, Array]:
        """map_from_tag of tags ahead, that face the robot."""
        tags = {}
        for i in range(count):
            x, y = self.random.uniform(1.0, 1.8), self.random.uniform(-0.6, 0.6)
            rpy = (np.pi / 2 + self.random.uniform(-0.3, 0.3), 0.0, -np.pi / 2)
            tags[i] = Transform.from_rpy((x, y, self.random.uniform(0.3, 1.2)), rpy).matrix
        return tags

    def _row(
        self, stamp: float, positions: Array, true: Array, told: Array, tags: dict[int, Array]
    ) -> dict[str, object]:
        base_from_map = _lifted(np.linalg.inv(true))
        places = {HAND_TAG: self.hand_tag(positions[None])[0]}
        places |= {tag: base_from_map @ pose for tag, pose in tags.items()}
        seen = []
        for tag, pose in places.items():
            corners, points, facing = self.seen(positions[None], pose[None])
            if _inside(corners).all() and points[0, :, 2].min() > 0.3 and facing[0] > 0.3:
                noisy = corners[0] + self.random.normal(0, self.noise, (4, 2))
                seen.append({"id": tag, "edge": EDGE, "corners": noisy.tolist()})
        return {
            "stamp": stamp,
            "camera": self.name,
            "intrinsics": LENS.tolist(),
            "joints": dict(zip(self.joints, positions.tolist(), strict=True)),
            "odometry": told.tolist(),
            "tags": seen,
        }


def write(path: Path, rows: list[dict[str, object]]) -> Path:
    path.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    return path


def _inside(corners: Array) -> Array:
    return np.asarray((corners > 4).all(-1) & (corners < np.array(SIZE) - 5).all(-1))


def _planar(pose: Array) -> Array:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return np.array([[c, -s, pose[0]], [s, c, pose[1]], [0, 0, 1]])


def _lifted(planar: Array) -> Array:
    made = np.eye(4)
    made[:2, :2], made[:2, 3] = planar[:2, :2], planar[:2, 2]
    return made


def _pose(matrix: Array) -> Array:
    return np.array([matrix[0, 2], matrix[1, 2], np.arctan2(matrix[1, 0], matrix[0, 0])])


def _arc(way: float, turn: float) -> Array:
    shrink = np.sinc(turn / 2 / np.pi)
    return np.array([shrink * np.cos(turn / 2) * way, shrink * np.sin(turn / 2) * way, turn])
