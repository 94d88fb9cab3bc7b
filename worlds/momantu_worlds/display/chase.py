"""The camera of a film: above and beside the robot, where no wall hides it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Pose2D, Transform, wrap_angle
from momantu_worlds.scenes.geometry.bodies import Body, Box

BASE_HEIGHT = 0.25
"""Height of the centre of a robot's base above the floor, m."""
PARALLEL = 1e-12
"""A ray that advances less than this along an axis counts as parallel to it, m."""


@dataclass(frozen=True, slots=True)
class ChaseConfig:
    """Where the camera of a video is placed."""

    distance: float = 2.3
    """Distance from the robot along the floor, m."""
    height: float = 2.9
    """Height above the floor, m: higher than the walls."""
    beside: float = math.radians(105)
    """Preferred direction from the robot, left or right of its heading, rad: to the side and
    slightly behind, so that both the working hand and the path ahead are visible."""
    loyalty: float = 0.4
    """Weight of the current direction against the preferred one."""
    choices: int = 16
    """Number of directions that are tried."""
    rate: float = 0.8
    """Angular speed of the camera around the robot, rad/s."""
    hurry: float = 4.0
    """Factor of that speed while a wall hides the robot."""
    lag: float = 0.6
    """Time constant with which the camera follows its target, s."""


class Chase:
    """A camera that follows a robot; call `pose` with increasing times."""

    def __init__(self, bodies: Iterable[Body], config: ChaseConfig | None = None) -> None:
        self._config = config or ChaseConfig()
        boxes = [
            ((body.map_from_body @ part.body_from_part).inverse(), part.geometry)
            for body in bodies
            if body.category == "wall"
            for part in body.parts
            if isinstance(part.geometry, Box)
        ]
        self._wall_from_map = np.array([transform.matrix for transform, _ in boxes])
        self._half = np.array([box.size for _, box in boxes]) / 2
        self._turn: float | None = None
        self._focus = np.zeros(3)
        self._time = 0.0

    def pose(self, base: Pose2D, now: float) -> Transform:
        """`map_from_camera`, x along its view, z up, for a robot at `base`."""
        config = self._config
        ahead = np.array([0.35 * math.cos(base.yaw), 0.35 * math.sin(base.yaw), 0.75])
        wanted = np.array([base.x, base.y, 0.0]) + ahead
        if self._turn is None:
            self._turn, self._focus = self._best(wanted, base.yaw, None), wanted
        else:
            passed = now - self._time
            self._focus = self._focus + (wanted - self._focus) * min(1.0, passed / config.lag)
            left = wrap_angle(self._best(wanted, base.yaw, self._turn) - self._turn)
            hidden = self._hidden(self._eye(self._focus, self._turn), self._focus)
            most = config.rate * passed * (config.hurry if hidden else 1.0)
            self._turn = wrap_angle(self._turn + max(-most, min(most, left)))
        self._time = now
        return looking(self._eye(self._focus, self._turn), self._focus)

    def _eye(self, focus: Array, turn: float) -> Array:
        config = self._config
        out = config.distance * np.array([math.cos(turn), math.sin(turn), 0.0])
        return np.array([focus[0], focus[1], config.height]) + out

    def _best(self, focus: Array, heading: float, current: float | None) -> float:
        """The direction with a free view that is nearest to the preferred and the current one."""
        config = self._config

        def cost(turn: float) -> float:
            bad = abs(abs(wrap_angle(turn - heading)) - config.beside)
            if current is not None:
                bad += config.loyalty * abs(wrap_angle(turn - current))
            return bad + (10.0 if self._hidden(self._eye(focus, turn), focus) else 0.0)

        turns = [2 * math.pi * i / config.choices for i in range(config.choices)]
        return min(turns, key=cost)

    def _hidden(self, eye: Array, focus: Array) -> bool:
        """Whether a wall lies between the eye and its target, or the robot's base below."""
        base = np.array([focus[0], focus[1], BASE_HEIGHT])
        return len(self._half) > 0 and (self._between(eye, focus) or self._between(eye, base))

    def _between(self, eye: Array, focus: Array) -> bool:
        """Slab test of a segment against all walls' boxes."""
        turn, shift = self._wall_from_map[:, :3, :3], self._wall_from_map[:, :3, 3]
        start, ray = turn @ eye + shift, turn @ (focus - eye)
        safe = np.where(np.abs(ray) < PARALLEL, PARALLEL, ray)
        near, far = (-self._half - start) / safe, (self._half - start) / safe
        enter, leave = np.minimum(near, far).max(axis=1), np.maximum(near, far).min(axis=1)
        return bool(np.any(np.maximum(enter, 0.0) < np.minimum(leave, 1.0)))


def looking(eye: Array, at: Array) -> Transform:
    """A camera pose at `eye` (3,), its x towards `at` (3,), its z up; not straight up or down."""
    forward = (at - eye) / np.linalg.norm(at - eye)
    left = np.cross((0.0, 0.0, 1.0), forward)
    left /= np.linalg.norm(left)
    return Transform.from_rotation(np.stack([forward, left, np.cross(forward, left)], 1), eye)
