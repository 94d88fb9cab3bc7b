"""Following a trajectory tick by tick, and detecting an arm that lags behind."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory
from momantu_bt.robot import Robot
from momantu_bt.skill import Clock
from momantu_skills.manipulation.motion.strain import Push, Strain

LAG = 0.35
"""Lag behind the trajectory that is normal at full speed, rad or m: two ticks of delay."""
PATIENCE = 0.3
"""Time without progress after which a lagging arm counts as stuck, s."""
SETTLE = 1.5
"""Time after the trajectory's end for the joints to arrive or to make progress, s."""
SLOWEST = 4.0
"""Longest duration of a trajectory, as a multiple of its planned one, for an arm slower than
specified."""
ASIDE = 0.15
"""Distance beside its path above which an arm is not merely late, rad or m."""
ARRIVED = 0.02
"""Distance from the end within which the joints have arrived, rad or m."""
STILL = 2e-3
"""Largest motion of a joint between two ticks that counts as standing still, rad or m: measurement
noise and creep. Reported speeds cannot be used: a blocked joint may report one although its
position does not change."""
CODE = "ARM_STUCK"

Watch = Callable[[Robot], bool]


def follow(
    robot: Robot,
    clock: Clock,
    actuator: str,
    trajectory: JointTrajectory,
    phase: str = "moving",
    until: Watch | None = None,
    strain: Strain | None = None,
) -> Generator[str, None, bool]:
    """Command a trajectory tick by tick; True once the arm has arrived and stands still.

    until: called at each tick; when it returns True, the actuator brakes along the path and the
    result is False. strain: tells when a motor pushes against something. Yields the phase. An arm
    that is late but makes progress on its path is waited for.

    Raises:
        Failure: ARM_STUCK if the joints lag behind or never arrive, or push against something; the
            actuator is stopped.
    """
    began = clock.now()
    delay = _Delay(trajectory)
    last = joints_of(robot, trajectory.names)
    while True:
        now = clock.now()
        positions = joints_of(robot, trajectory.names)
        still = float(np.abs(positions - last).max()) < STILL
        last = positions
        if until is not None and until(robot):
            yield from brake(robot, clock, actuator, phase)
            return False
        if now - began >= trajectory.duration and still and _arrived(positions, trajectory):
            return True
        if strain is not None and (push := strain.felt(efforts_of(robot, trajectory.names))):
            robot.stop(actuator)
            raise _pushing(trajectory, push, now - began)
        if delay.hopeless(positions, now - began):
            robot.stop(actuator)
            raise _stuck(trajectory, positions, now - began)
        robot.command(actuator, trajectory)
        yield phase


class _Delay:
    """Distinguishes a late arm from a stuck one by its progress along the trajectory."""

    def __init__(self, trajectory: JointTrajectory) -> None:
        self._trajectory = trajectory
        self._at = 0
        """Index of the farthest point that the arm has come near."""
        self._advanced = 0.0
        """Time of the last progress, s after the start."""

    def hopeless(self, positions: Array, after: float) -> bool:
        """Whether joints at `positions` (n,), `after` seconds from the start, cannot arrive."""
        trajectory = self._trajectory
        times = trajectory.times
        due = min(int(np.searchsorted(times, after, side="right")), len(times) - 1)
        off = np.abs(trajectory.positions[self._at : due + 1] - positions).max(axis=1)
        nearest = int(np.argmin(off))
        if nearest > 0 and float(off[nearest]) < ASIDE:
            self._at += nearest
            self._advanced = after
        lag = float(np.abs(positions - expected(trajectory, after)).max())
        if lag < LAG and after <= trajectory.duration:
            self._advanced = after
        patience = PATIENCE if lag >= LAG else SETTLE
        return after - self._advanced > patience or after > SLOWEST * trajectory.duration + SETTLE


def brake(
    robot: Robot, clock: Clock, actuator: str, phase: str = "stopping"
) -> Generator[str, None, None]:
    """Stop an actuator and wait until its joints stand still, at most SETTLE seconds."""
    joints = robot.description.actuators[actuator].joints
    began = clock.now()
    last = joints_of(robot, joints)
    robot.stop(actuator)
    yield phase
    while clock.now() - began < SETTLE:
        now = joints_of(robot, joints)
        if float(np.abs(now - last).max()) < STILL:
            return
        last = now
        yield phase


def expected(trajectory: JointTrajectory, after: float) -> Array:
    """Joints (n,) of a trajectory after `after` seconds, interpolated linearly."""
    times = trajectory.times
    at = min(max(after, 0.0), trajectory.duration)
    i = min(int(np.searchsorted(times, at, side="right")), len(times) - 1)
    share = (at - times[i - 1]) / (times[i] - times[i - 1])
    before, later = trajectory.positions[i - 1], trajectory.positions[i]
    return np.asarray(before + share * (later - before))


def joints_of(robot: Robot, names: Sequence[str]) -> Array:
    """Measured positions (n,) of joints."""
    state = robot.state()
    return np.array([state.position(name) for name in names])


def efforts_of(robot: Robot, names: Sequence[str]) -> Array:
    """Measured efforts (n,) of joints, Nm or N."""
    state = robot.state()
    return np.array([state.efforts[state.names.index(name)] for name in names])


def _arrived(positions: Array, trajectory: JointTrajectory) -> bool:
    return float(np.abs(positions - trajectory.positions[-1]).max()) < ARRIVED


def _stuck(trajectory: JointTrajectory, positions: Array, after: float) -> Failure:
    error = np.abs(positions - expected(trajectory, after))
    worst = int(np.argmax(error))
    return Failure(
        CODE,
        f"{trajectory.names[worst]} is {error[worst]:.2f} from where its trajectory asks it to "
        f"be after {after:.1f} s: something holds the arm, or its driver does not answer",
        joint=trajectory.names[worst],
        error=float(error[worst]),
    )


def _pushing(trajectory: JointTrajectory, push: Push, after: float) -> Failure:
    name = trajectory.names[push.joint]
    return Failure(
        CODE,
        f"{name} gives {push.rise:.0f} Nm (or N) more than a moment before, after {after:.1f} s: "
        "the arm pushes against something, or something holds it",
        joint=name,
        rise=push.rise,
    )
