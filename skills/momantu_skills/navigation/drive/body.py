"""Arm and load of the moving base: kept away from what stands at their height."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.messages import RobotState
from momantu_bt.robot import BaseLimits
from momantu_bt.service import PlanningScene

with lazily():
    from momantu_skills.navigation.control import guard

BEYOND = 0.6
"""How far beyond arm and load obstacles are looked for, m: the base does not get farther before it
has stopped."""
SPARE = 0.1
"""Distance by which the base may come nearer than a simple bound says, and the radius of a column,
m."""


class BodyScene(PlanningScene, Protocol):
    """A planning scene that knows of the heights of the robot's parts and of its surroundings.

    Columns are rows of x, y, lowest and highest point, and radius, base frame, m.

    low_things: (n, 2) in the map, m: where pictures showed things below the laser's plane, or where
    what the hand has lost may lie. A camera that looks ahead does not see what lies near the base,
    so who drives next must be told of it.
    """

    low_things: Array

    def overhang(self, state: RobotState) -> Array:
        """Discs (k, 5) that cover what of arm and held object reaches beyond the base.

        A row has x, y, radius, lowest and highest point, base frame, m.
        """
        ...

    def solids(self, state: RobotState, hits: Array, reach: float) -> Array:
        """Columns (n, 5) within `reach` m of the base: what laser and maps know there.

        hits: points (m, 2) that the laser met, base frame, m. All of it is as tall as a wall;
        surfaces are left out.
        """
        ...

    def not_free(self, state: RobotState, columns: Array) -> Array:
        """Those parts (m, 5) of columns (n, 5) that no picture shows to be free."""
        ...


class Body:
    """Judges commands of the base by what arm and load would meet.

    parts: discs (k, 5) of `BodyScene.overhang`; none while the arm stays within the base's outline.
    """

    def __init__(self, scene: BodyScene, limits: BaseLimits) -> None:
        self._scene, self._limits = scene, limits
        self.parts = self._solids = np.empty((0, 5))

    def follow(self, state: RobotState) -> None:
        """Take over the arm's posture, and what is held."""
        self.parts = self._scene.overhang(state)

    def look(self, state: RobotState, hits: Array) -> None:
        """Collect what stands around. hits: points (n, 2) of the newest scan, base frame, m."""
        self._state = state
        if not len(self.parts):
            return
        out = float((np.hypot(self.parts[:, 0], self.parts[:, 1]) + self.parts[:, 2]).max())
        found = self._scene.solids(state, hits, out + BEYOND)
        low, high = self.parts[:, 3].min(), self.parts[:, 4].max()
        self._solids = found[(found[:, 2] < high) & (found[:, 3] > low)]

    def share(
        self, command: tuple[float, float, float], speed: tuple[float, float, float]
    ) -> float:
        """Return the share of a command at which arm and load meet nothing, as `guard` says.

        command, speed: (m/s ahead, rad/s, m/s to the left), commanded and measured.
        """
        near = self._within_reach(command, speed)
        if not near.any():
            return 1.0
        found = guard.safe_share(command, speed, self._limits, self.parts, self._solids[near])
        if found == 1.0:
            return found
        left = self._scene.not_free(self._state, self._solids[near])
        self._solids = np.vstack([self._solids[~near], left])
        return guard.safe_share(command, speed, self._limits, self.parts, left)

    def _within_reach(
        self, command: tuple[float, float, float], speed: tuple[float, float, float]
    ) -> NDArray[np.bool_]:
        """Which solids (n,) a part could come near before the base has stopped."""
        near = np.zeros(len(self._solids), dtype=np.bool_)
        if not len(self.parts):
            return near
        v, w, u = (max(abs(a), abs(b)) for a, b in zip(command, speed, strict=True))
        out = float(np.hypot(self.parts[:, 0], self.parts[:, 1]).max())
        linear = max(v, u) * guard.REACTION + max(v, u) ** 2 / self._limits.linear_acceleration
        turn = w * guard.REACTION + w**2 / self._limits.angular_acceleration
        reach = linear + out * turn + guard.HARD_MARGIN + SPARE
        for x, y, radius, low, high in self.parts:
            off = self._solids[:, :2] - (x, y)
            at_height = (self._solids[:, 2] < high) & (self._solids[:, 3] > low)
            near |= at_height & (np.hypot(off[:, 0], off[:, 1]) < radius + reach)
        return near
