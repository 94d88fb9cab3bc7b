"""The driver of an arm or head: trajectories, positions, braking and the watchdog."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import JointPositions, JointTrajectory
from momantu_bt.robot import WATCHDOG, JointLimit
from momantu_worlds.sapien.config import STEP, SUB_STEPS
from momantu_worlds.sapien.drives.path import Path

START_TOLERANCE = 0.05
"""Largest distance between a trajectory's start and the joints, rad or m; more means a plan from
another position."""
LIMIT_TOLERANCE = 0.01
"""How far a goal may exceed a position limit, rad or m: measured joints have errors of a few
mrad."""
SPEED_TOLERANCE = 1.05
"""Factor by which a trajectory may exceed a speed limit between its points."""
GIVE_WAY = 0.01
"""Distance between command and joint at which a drive drops its goal, rad or m. In free motion it
is below 0.003 even if the base jerks; more means an obstacle, which is pushed with 100 Nm or N
already."""
HARD_PUSH = 100.0
"""A drive with low stiffness drops its goal only when it pushes with this, Nm or N, or with its
full force."""
LEAST_STIFFNESS = 1e-9
"""Least stiffness, Nm/rad or N/m; a drive without stiffness follows no goal and never drops one."""
WEAK = 5.0
"""Joints with less effort than this, Nm or N (a head's), cannot cause harm and never drop a
goal."""


class JointDrive:
    """Moves a group of joints. Goals are in measured angles: `offset` = measured - true.

    If a joint is blocked, the goal is dropped and the joints hold their positions, as in real arm
    controllers when a path's tolerance is exceeded. New goals are accepted as usual.
    """

    def __init__(
        self,
        names: Sequence[str],
        joints: Sequence[Any],
        limits: Sequence[JointLimit],
        offset: Array,
        efforts: Array,
        stiffness: Array,
    ) -> None:
        self.names = tuple(names)
        self._joints = list(joints)
        self._offset = offset
        self._lower = np.array([-math.inf if m.lower is None else m.lower for m in limits])
        self._upper = np.array([math.inf if m.upper is None else m.upper for m in limits])
        self._speed = np.array([m.velocity for m in limits])
        self._acceleration = np.array([m.acceleration for m in limits])
        pushing = np.minimum(efforts, HARD_PUSH) / np.maximum(stiffness, LEAST_STIFFNESS)
        self._tolerance = np.where(efforts > WEAK, np.maximum(GIVE_WAY, pushing), math.inf)
        self._command: object = object()
        self._given_up: object = object()
        self._last_command = -math.inf
        self._path: Path | None = None
        self._goal: Array | None = None
        self._braking = False
        self.position = np.zeros(len(self.names))
        self.velocity = np.zeros(len(self.names))
        self._targets: tuple[Array, Array] | None = None

    def place(self, true_positions: Array) -> None:
        """Start by holding the current joint positions, true angles (n,)."""
        self.position = np.array(true_positions, dtype=np.float64)
        self.velocity = np.zeros(len(self.names))
        self._set(self.position, self.velocity)

    def command(self, goal: object, now: float) -> None:
        """Set a trajectory, or positions to move to.

        Raises:
            ValueError: another kind of goal, other joints, outside the limits, or a trajectory
                that does not start at the current joint positions.
        """
        if goal is self._given_up:
            return
        if isinstance(goal, JointTrajectory):
            if self._path is not None and self._path.trajectory is goal:
                self._path.pace_goal = 1.0
            else:
                self._follow(goal)
        elif isinstance(goal, JointPositions):
            self._go(goal)
        else:
            raise ValueError(
                f"joints take JointTrajectory or JointPositions, not {type(goal).__name__}"
            )
        self._command, self._last_command = goal, now

    def stop(self) -> None:
        """Brake within the acceleration limits, on the path if there is one."""
        if self._path is not None:
            self._path.pace_goal = 0.0
        if self._goal is not None:
            self._braking = True

    def begin_tick(self, now: float, true_positions: Array) -> None:
        """Compute the targets for the physics steps of the next tick; `true_positions` (n,) now."""
        led = self._last_command > -math.inf  # joints that nobody moves hold their place
        if led and bool(np.any(np.abs(self.position - true_positions) > self._tolerance)):
            self._give_way(true_positions)
        if now - self._last_command > WATCHDOG:
            self.stop()
        self._targets = None
        if self._path is not None:
            if not (self._path.resting and not self.velocity.any()):
                self._targets = self._path.advance(STEP, SUB_STEPS)
        elif self._goal is not None:
            self._targets = self._toward(self._goal)

    def apply(self, index: int) -> None:
        """Set the targets of physics step `index` of this tick."""
        if self._targets is None:
            return
        self.position, self.velocity = self._targets[0][index], self._targets[1][index]
        self._set(self.position, self.velocity)

    def _give_way(self, true_positions: Array) -> None:
        self._given_up = self._command
        self._path, self._goal = None, None
        self.place(true_positions)

    def _set(self, position: Array, velocity: Array) -> None:
        for joint, p, v in zip(self._joints, position.tolist(), velocity.tolist(), strict=True):
            joint.set_drive_target(p)
            joint.set_drive_velocity_target(v)

    def _follow(self, goal: JointTrajectory) -> None:
        if sorted(goal.names) != sorted(self.names):
            raise ValueError(
                f"the trajectory moves {', '.join(goal.names)}; expected {', '.join(self.names)}"
            )
        columns = [goal.names.index(name) for name in self.names]
        positions = np.asarray(goal.positions, dtype=np.float64)[:, columns]
        self._check_shape(goal)
        self._check_positions(positions)
        distance = np.abs(positions[0] - self.position - self._offset)
        worst = int(np.argmax(distance))
        if distance[worst] > START_TOLERANCE:
            raise ValueError(
                f"the trajectory starts with {self.names[worst]} at {positions[0, worst]:.3f}, but "
                f"it is commanded to {self.position[worst] + self._offset[worst]:.3f}; plan from "
                "the present state"
            )
        start = self.position, self.velocity
        path = Path(goal, columns, start, self._offset, self._acceleration)
        self._check_speed(goal, columns)
        self._path, self._goal = path, None

    def _check_shape(self, goal: JointTrajectory) -> None:
        times = np.asarray(goal.times)
        shape = (len(times), len(self.names))
        if goal.positions.shape != shape or goal.velocities.shape != shape:
            raise ValueError(
                f"positions {goal.positions.shape} and velocities {goal.velocities.shape} must "
                f"both be {shape}: one row per time"
            )
        if len(times) == 0 or times[0] != 0.0 or not bool(np.all(np.diff(times) > 0.0)):
            raise ValueError("the times of a trajectory must start at 0 and rise")

    def _check_positions(self, positions: Array) -> None:
        outside = (positions < self._lower - LIMIT_TOLERANCE) | (
            positions > self._upper + LIMIT_TOLERANCE
        )
        if not np.all(np.isfinite(positions)):
            raise ValueError("a goal holds a position that is not a finite number")
        if outside.any():
            row, column = np.argwhere(outside)[0]
            raise ValueError(
                f"{self.names[column]} at {positions[row, column]:.3f} is outside "
                f"{self._lower[column]:.3f} to {self._upper[column]:.3f}"
            )

    def _check_speed(self, goal: JointTrajectory, columns: list[int]) -> None:
        speeds = np.abs(np.asarray(goal.velocities, dtype=np.float64)[:, columns])
        if len(goal.times) > 1:
            steps = np.diff(np.asarray(goal.positions, dtype=np.float64)[:, columns], axis=0)
            between = np.abs(steps) / np.diff(np.asarray(goal.times))[:, None]
            speeds = np.vstack([speeds, between])
        if not np.all(speeds <= self._speed * SPEED_TOLERANCE):
            column = int(np.argmax((speeds / self._speed).max(axis=0)))
            raise ValueError(
                f"{self.names[column]} would move at {speeds[:, column].max():.3f}; "
                f"its limit is {self._speed[column]:.3f}"
            )

    def _go(self, goal: JointPositions) -> None:
        unknown = [name for name in goal.names if name not in self.names]
        if unknown or len(goal.names) != len(goal.positions):
            raise ValueError(
                f"positions for {', '.join(goal.names)} with {len(goal.positions)} numbers; "
                f"the joints are {', '.join(self.names)}"
            )
        here = self._goal is None or self._braking
        wanted = np.array(self.position + self._offset if here else self._goal)
        for name, value in zip(goal.names, goal.positions, strict=True):
            wanted[self.names.index(name)] = value
        if here or self._goal is None or not np.array_equal(wanted, self._goal):
            self._check_positions(wanted[None])
        self._path, self._goal, self._braking = None, wanted, False

    def _toward(self, goal: Array) -> tuple[Array, Array] | None:
        """Targets towards `goal` with trapezoidal speed, from any speed; None at rest."""
        target = goal - self._offset
        if not self.velocity.any() and (self._braking or bool(np.all(self.position == target))):
            return None
        ways = [
            _trapezoid(*motion, braking=self._braking)
            for motion in zip(
                self.position.tolist(),
                self.velocity.tolist(),
                target.tolist(),
                self._speed.tolist(),
                self._acceleration.tolist(),
                strict=True,
            )
        ]
        steps = np.array(ways)
        return steps[:, :, 0].T, steps[:, :, 1].T


def _trapezoid(
    p: float, v: float, target: float, speed: float, acceleration: float, *, braking: bool
) -> list[tuple[float, float]]:
    """Position and velocity of one joint in the steps of a tick; plain numbers are the fastest."""
    change = acceleration * STEP
    half = 0.5 * change
    way = []
    for _ in range(SUB_STEPS):
        if braking:
            v -= min(max(v, -change), change)
            p += v * STEP
        else:
            left = target - p
            # the fastest speed from which the steps that follow can brake to rest at the target
            brakeable = math.sqrt(half * half + 2.0 * acceleration * abs(left)) - half
            wanted = math.copysign(min(brakeable, speed), left)
            v += min(max(wanted - v, -change), change)
            arrives = abs(left) <= change * STEP and abs(v) <= 2.0 * change
            p, v = (target, 0.0) if arrives else (p + v * STEP, v)
        way.append((p, v))
    return way
