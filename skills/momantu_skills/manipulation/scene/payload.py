"""The weight in the hand: the load on the wrist, beside that of the empty hand."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM, FrameBuffer
from momantu_bt.geometry import Array
from momantu_bt.messages import RobotState, WrenchReading
from momantu_bt.robot import Robot, RobotDescription, WristWrench

EMPTY = 20
"""Readings with the empty hand of which the median is used."""
APART = 0.25
"""Time between two of them, s: they cover 5 s, and a short contact of the open hand, as at the end
of an approach, does not change their median."""
OPEN = 0.95
"""Share of the widest opening from which the hand is open and holds nothing."""
AT_REST = 0.02
"""Fastest joint, rad/s or m/s, and base, at which the load is weight alone. A hand of 1.5 kg that
is accelerated by 1 m/s2 adds 1.5 N."""
SHAKING = 0.04
"""Least time between two states of which the positions tell whether joints stand still, s."""
HEAVY = 3.0
"""Load of the empty hand above which the sensor measures the hand's own weight too, N. The load
then depends on how the hand is turned."""
TURNED = math.radians(15.0)
"""Largest turn of such a hand, rad, at which its load with nothing in it still counts: a sensor of
10 N is then wrong by 0.3 N along the vertical."""
BIAS = 0.6
"""Standard deviation of the load while the empty hand has not been measured, N, per axis."""
NOISE = 0.25
"""Standard deviation of one reading, N."""
MEDIAN = 1.25
"""Standard deviation of a median, relative to that of a mean."""
RAISED = 0.03
"""Height of the hand above its lowest place since the fingers moved, from which nothing under it
carries what it holds any more, m."""
MOVED = 0.0025
"""Change of the opening that means that the fingers have moved, m: six sigma of its noise."""


@dataclass(frozen=True, slots=True)
class Weight:
    """A weight, N.

    noise: standard deviation of what differs from reading to reading, N. shared: the same of the
    error that all readings have in common. aside: the load along the odom frame's x and y, N, NaN
    if it is not known: what hangs in the hand pulls straight down.
    """

    value: float
    noise: float
    shared: float
    aside: tuple[float, float] = (math.nan, math.nan)

    @property
    def sigma(self) -> float:
        """Standard deviation of the value, N."""
        return math.hypot(self.noise, self.shared)


def mean_weight(weights: Sequence[Weight]) -> Weight:
    """The mean of several readings: their noise averages out, and what they share does not."""
    rows = [(w.value, w.noise, w.shared, *w.aside) for w in weights]
    value, noise, shared, x, y = (float(mean) for mean in np.mean(rows, axis=0))
    return Weight(value, noise / math.sqrt(len(weights)), shared, (x, y))


def wrist_sensor(description: RobotDescription) -> str | None:
    """Name of the sensor of the load on the wrist; None on robots without one."""
    sensors = description.sensors.items()
    return next((name for name, sensor in sensors if isinstance(sensor, WristWrench)), None)


class Payload:
    """Learns the load of the empty hand while the hand is open, and weighs what it holds."""

    def __init__(self, description: RobotDescription, frames: FrameBuffer) -> None:
        self._description, self._frames = description, frames
        self._empty: deque[Array] = deque(maxlen=EMPTY)
        self._up: Array | None = None
        self._measured = -math.inf
        self._width, self._followed = math.nan, -math.inf
        self._states: deque[RobotState] = deque(maxlen=2)
        self._lowest = self._height = math.inf

    @property
    def raised(self) -> bool:
        """Whether the hand was raised since its fingers moved: nothing can carry what it holds."""
        return self._height > self._lowest + RAISED

    def update(self, robot: Robot, state: RobotState) -> None:
        """Note the hand's height; measure the empty hand if it is open and at rest."""
        effector = self._description.end_effector
        if effector is None:
            return
        if not self._states or state.stamp > self._states[-1].stamp:
            self._states.append(state)
        open_ = state.gripper_width >= OPEN * effector.max_width
        self._follow(state, effector.frame, open_)
        if not at_rest(state) or not open_ or state.stamp < self._measured + APART:
            return
        load = self._load(robot)
        if load is not None:
            self._empty.append(load[0])
            self._up, self._measured = load[1][2], state.stamp

    def _follow(self, state: RobotState, frame: str, open_: bool) -> None:
        """Note how high the hand is above its lowest place since the fingers moved."""
        moved = not abs(state.gripper_width - self._width) <= MOVED
        if not moved and (open_ or state.stamp < self._followed + APART):
            return
        base_from_hand = self._frames.kinematics.base_from_frame(frame, state.joints())
        self._height = float((state.odom_from_base @ base_from_hand).position[2])
        self._lowest = self._height if moved else min(self._lowest, self._height)
        self._width = state.gripper_width if moved else self._width
        self._followed = state.stamp

    def weigh(self, robot: Robot) -> Weight | None:
        """Weight in the hand now.

        None without a sensor, in motion, or where the empty hand's load is not known well enough.
        """
        if not self._rests(robot.state()):
            return None
        load = self._load(robot)
        if load is None:
            return None
        force, odom_from_sensor = load
        if self._up is None:
            return _weight(odom_from_sensor @ force, BIAS, tells_aside=True)
        empty = np.median(self._empty, axis=0)
        turned = math.acos(float(np.clip(self._up @ odom_from_sensor[2], -1.0, 1.0)))
        heavy = np.linalg.norm(empty) > HEAVY
        if heavy and turned > TURNED:
            return None
        shared = MEDIAN * NOISE / math.sqrt(len(self._empty))
        return _weight(odom_from_sensor @ (force - empty), shared, tells_aside=not heavy)

    def _rests(self, state: RobotState) -> bool:
        """Whether the robot stands still: by its speeds, or by where its joints were before.

        What is gripped may shake joints that stay where they are.
        """
        if at_rest(state):
            return True
        before = next((s for s in self._states if s.stamp < state.stamp - SHAKING), None)
        if before is None or max(abs(state.linear), abs(state.angular)) >= AT_REST:
            return False
        moved = float(np.abs(state.positions - before.positions).max(initial=0.0))
        return moved < AT_REST * (state.stamp - before.stamp)

    def _load(self, robot: Robot) -> tuple[Array, Array] | None:
        """The force (3,) in the sensor's frame, N, and odom_from_sensor (3, 3)."""
        name = wrist_sensor(robot.description)
        if name is None:
            return None
        try:
            reading = robot.read(name)
            rotation = self._frames.lookup(ODOM, reading.frame, reading.stamp).rotation
        except Failure:
            return None
        assert isinstance(reading, WrenchReading)
        return reading.force, rotation


def _weight(load: Array, shared: float, *, tells_aside: bool) -> Weight:
    """What a load (3,) in odom, N, tells.

    tells_aside: not where the hand's own weight is in it, of which a small turn makes a load aside.
    """
    aside = (float(load[0]), float(load[1])) if tells_aside else (math.nan, math.nan)
    return Weight(-float(load[2]), NOISE, shared, aside)


def at_rest(state: RobotState) -> bool:
    """Whether joints and base stand still, as far as their reported speeds tell."""
    fastest = float(np.abs(state.velocities).max(initial=0.0))
    return max(fastest, abs(state.linear), abs(state.angular)) < AT_REST
