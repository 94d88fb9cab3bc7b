"""RateController, DistanceController, SpeedController, SingleTrigger: Nav2's decorators of pace.

Each starts its child first, and later when it is due; a child that is RUNNING is ticked on every
tick, and its status is the node's. In between the node is RUNNING. Time is the world's clock's,
the way and the speed are odometry's; without a world the robot does not move.
"""

from __future__ import annotations

import math

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts
from momantu_bt.engine.outside import POSITION, SPEED
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.status import IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, FRAME_UNKNOWN, WRONG_TYPE, Failure
from momantu_bt.geometry import Array
from momantu_bt.nodes.goals import GOAL_NAMES, GOAL_PORTS, Goals
from momantu_bt.tree.catalogue.codes import and_also
from momantu_bt.tree.catalogue.flow import again, around
from momantu_bt.tree.catalogue.spec import Dialect, decorator, input_port

SLOWEST = 0.001
"""Hz: the least of a rate, which one is divided by."""


class _Paced(Decorator):
    """Subclasses say when the child is due, and what its start and its success mean to them."""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.first = True

    def begin(self) -> None:
        """The node starts."""

    def is_due(self) -> bool:
        """Whether the child is to be started, which it is the first time anyway."""
        raise NotImplementedError(f"{type(self).__name__} has no is_due()")

    def succeeded(self) -> None:
        """The child has succeeded."""

    def step(self) -> Status:
        """Tick the child when it is at work, or due."""
        if self.state is IDLE:
            self.first = True
            self.begin()
        self.state = RUNNING
        due = self.is_due()
        if not (self.first or due or self.child.state is RUNNING):
            return RUNNING
        self.first = False
        status = self.child.execute()
        if status is SUCCESS:
            self.succeeded()
        return self.pass_on(status)


class RateController(_Paced):
    """Due when 1 / `hz` has passed since the child's last success, or since the start."""

    spec = decorator(
        "RateController",
        "rate_controller",
        "Starts the child at most so often.",
        input_port("hz", float, "starts per second", 10.0, "Hz", least=SLOWEST),
        dialect=Dialect.NAV2,
        flow=again(around),
    )

    since = 0.0
    period = 0.0

    def begin(self) -> None:
        """The time begins; `hz` is read."""
        self.since = self.context.now
        self.period = 1.0 / self.inputs["hz"]

    def is_due(self) -> bool:
        """Whether the period is over."""
        return self.context.now - self.since >= self.period - CLOCK_SLACK

    def succeeded(self) -> None:
        """The time begins again."""
        self.since = self.context.now


class DistanceController(_Paced):
    """Due when the robot is `distance` from where the child last succeeded, or the node began."""

    spec = decorator(
        "DistanceController",
        "distance_controller",
        "Starts the child each time the robot has come so far.",
        input_port("distance", float, "how far", 1.0, "m", least=0),
        input_port("global_frame", str, "where it is measured", "odom"),
        input_port("robot_base_frame", str | None, "what is measured; the robot's base", None),
        dialect=Dialect.NAV2,
        flow=again(around),
        codes=and_also(FRAME_UNKNOWN),
    )

    origin: Array | None = None

    def begin(self) -> None:
        """The way begins here."""
        self.origin = self._position()

    def is_due(self) -> bool:
        """Whether the robot has come far enough."""
        here = self._position()
        if here is None or self.origin is None:
            return False
        distance: float = self.inputs["distance"]
        return math.dist(here, self.origin) >= distance

    def succeeded(self) -> None:
        """The distance begins again."""
        self.origin = self._position()

    def _position(self) -> Array | None:
        return self.context.ask(POSITION, self._position_now)

    def _position_now(self) -> Array | None:
        body = self.context.body
        if body is None:
            return None
        base = self.inputs["robot_base_frame"] or body.actuators.robot.description.base_frame
        return body.frames.lookup(self.inputs["global_frame"], base).position


class SpeedController(_Paced):
    """Due after a period that is read off the robot's speed when the one before is over.

    The rate goes from `min_rate` at `min_speed` to `max_rate` at `max_speed`. A goal that has
    changed makes the child due at once, and the period the shortest.
    """

    spec = decorator(
        "SpeedController",
        "speed_controller",
        "Starts the child the more often the faster the robot drives, and at a new goal.",
        input_port(
            "min_rate", float, "starts per second at the lowest speed", 0.1, "Hz", least=SLOWEST
        ),
        input_port(
            "max_rate", float, "starts per second at the highest speed", 1.0, "Hz", least=SLOWEST
        ),
        input_port("min_speed", float, "the lowest speed", 0.0, "m/s", least=0),
        input_port("max_speed", float, "the highest speed", 0.5, "m/s", least=0),
        *GOAL_PORTS,
        may_be_empty=GOAL_NAMES,
        dialect=Dialect.NAV2,
        flow=again(around),
    )

    since = 0.0
    period = 0.0

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs(*GOAL_NAMES)
        self.goals = Goals(self.inputs)

    def begin(self) -> None:
        """The shortest period begins."""
        self.goals.remember()
        self._restart()

    def is_due(self) -> bool:
        """Whether the period is over; then the next one is as long as the speed says."""
        if self.goals.have_changed():
            self._restart()
            self.first = True
        if self.context.now - self.since < self.period - CLOCK_SLACK:
            return False
        self.period = 1.0 / self._rate()
        self.since = self.context.now
        return True

    def _restart(self) -> None:
        self.period = 1.0 / self.inputs["max_rate"]
        self.since = self.context.now

    def _rate(self) -> float:
        slow, fast = self.inputs["min_rate"], self.inputs["max_rate"]
        lowest, highest = self.inputs["min_speed"], self.inputs["max_speed"]
        if highest <= lowest:
            raise Failure(WRONG_TYPE, f"max_speed is {highest:g}, not above min_speed {lowest:g}")
        share = (self._speed() - lowest) / (highest - lowest)
        return float(min(max(slow + share * (fast - slow), slow), fast))

    def _speed(self) -> float:
        return self.context.ask(SPEED, self._speed_now)

    def _speed_now(self) -> float:
        body = self.context.body
        return 0.0 if body is None else abs(body.actuators.robot.state().linear)


class SingleTrigger(Decorator):
    """Runs the child to its end once; FAILURE from then on, until the node is restarted."""

    spec = decorator(
        "SingleTrigger",
        "single_trigger",
        "Runs the child once, then fails until it is started anew.",
        dialect=Dialect.NAV2,
        flow=around,
        around=lambda node: "once at each start",
    )

    triggered = False

    def step(self) -> Status:
        """Tick the child until its end."""
        if self.state is IDLE:
            self.triggered = False
        self.state = RUNNING
        if self.triggered:
            return self.fail(FAILED, f"{self.child.name} has had its one run")
        status = self.child.execute()
        self.triggered = status.completed
        return self.pass_on(status)
