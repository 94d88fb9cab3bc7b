"""A base that obeys at once, in a costmap of boxes: what `Vehicle` offers to manoeuvres."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from types import SimpleNamespace

import numpy as np
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.control.footprint import discs, half_width
from momantu_skills.navigation.drive.caution import Caution
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import BaseLimits

LIMITS = BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0)
OUTLINE = np.array([(0.25, 0.2), (-0.25, 0.2), (-0.25, -0.2), (0.25, -0.2)])

Boxes = Sequence[tuple[float, float, float, float]]
"""x from, y from, x to, y to, m."""


class Obedient:
    """A perfect base within its accelerations. least: room that the base had on its way.

    stuck: it is commanded but stands. arm: how far an arm reaches ahead of the outline, m.
    """

    sight = SimpleNamespace(blind=0.0)

    def __init__(
        self, start: Pose2D, boxes: Boxes = (), arm: float = 0.0, limits: BaseLimits = LIMITS
    ) -> None:
        cells = np.zeros((120, 160), np.uint8)
        cells[[0, -1], :] = OCCUPIED
        cells[:, [0, -1]] = OCCUPIED
        for x0, y0, x1, y1 in boxes:
            rows = slice(round(y0 / 0.05), round(y1 / 0.05))
            cells[rows, round(x0 / 0.05) : round(x1 / 0.05)] = OCCUPIED
        self.config, self.limits = NavigationConfig(), limits
        self.glides = limits.sideways > 0.0
        self.costmap = Costmap(GridMap(cells, 0.05, (0.0, 0.0)), None, self.config)
        self.caution = Caution(self.costmap)
        self.base_discs = self.low_discs = discs(OUTLINE)
        reach = np.array([[0.25 + arm - 0.05, 0.0, 0.05]]) if arm else np.empty((0, 3))
        self.discs = np.vstack([self.base_discs, reach])
        self.reaches_over = False
        self.half_width = half_width(OUTLINE)
        self.start, self.at, self.time = start, Pose2D(0.0, 0.0), 0.0
        self.v = self.w = self.u = 0.0
        self.shift = Pose2D(0.0, 0.0)
        self.blocked_for = self.blocked_total = 0.0
        self.stuck, self.least, self.phases = False, np.inf, list[str]()

    def now(self) -> float:
        return self.time

    def odom_from_base(self) -> Pose2D:
        return self.at

    def map_from_odom(self) -> Pose2D:
        return self.start @ self.shift

    def pose(self) -> Pose2D:
        return self.map_from_odom() @ self.at

    mapped = True

    def show(self, path: Array) -> None:
        """Nobody watches."""

    def speed(self) -> tuple[float, float, float]:
        return self.v, self.w, self.u

    def sense(self, *, depth: bool = True) -> None:
        self.least = min(self.least, self.room(self.pose(), whole=False))

    def room(self, pose: Pose2D, *, whole: bool) -> float:
        return self.costmap.room(pose, self.discs if whole else self.low_discs)

    def drive(
        self, linear: float, angular: float, phase: str, lateral: float = 0.0
    ) -> Generator[str, None, None]:
        assert lateral == 0.0 or self.glides
        self.phases.append(phase)
        self.blocked_for = self.blocked_for + 0.1 if self.stuck else 0.0
        if not self.stuck:
            for _ in range(10):
                self.v += float(np.clip(linear - self.v, -0.01, 0.01))
                self.w += float(np.clip(angular - self.w, -0.03, 0.03))
                self.u += float(np.clip(lateral - self.u, -0.01, 0.01))
                self.at = self.at @ Pose2D(0.01 * self.v, 0.01 * self.u, 0.01 * self.w)
        self.time += 0.1
        yield phase

    def stands(self) -> bool:
        return all(abs(speed) < 0.01 for speed in self.speed())

    def stop(self, phase: str) -> Generator[str, None, None]:
        while not self.stands():
            yield from self.drive(0.0, 0.0, phase)

    def wait(self, seconds: float, phase: str) -> Generator[str, None, None]:
        end = self.time + seconds - 1e-6
        while self.time < end:
            yield from self.drive(0.0, 0.0, phase)


MakeObedient = Callable[..., Obedient]
RunMove = Callable[..., object]
