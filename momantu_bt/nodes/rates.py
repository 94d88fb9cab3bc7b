"""RateController, DistanceController, SpeedController, SingleTrigger: limit how often a child runs.

Each controller starts its child in its first tick, and again whenever the child is due. A child
that is RUNNING is ticked on every tick, and its status is the node's. Between two runs of the child
the node is RUNNING. Time is that of the world's clock; distance and speed come from odometry.
Without a world the robot does not move.
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

SLOWEST = 1e-9
"""Lowest valid rate, Hz; a period is 1 / rate."""


class _Paced(Decorator):
    """The base of the controllers; subclasses define when the child is due."""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.first = True

    def begin(self) -> None:
        """Called when the node starts."""

    def is_due(self) -> bool:
        """Whether to start the child; the first tick starts it in any case."""
        raise NotImplementedError(f"{type(self).__name__} has no is_due()")

    def succeeded(self) -> None:
        """Called when the child has succeeded."""

    def step(self) -> Status:
        """Tick the child if it is running or due."""
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
    """The child is due 1 / `hz` after its last success, or after the node's start."""

    spec = decorator(
        "RateController",
        "rate_controller",
        "Runs the child at most `hz` times per second.",
        input_port("hz", float, "starts per second", 10.0, "Hz", least=SLOWEST),
        dialect=Dialect.NAV2,
        flow=again(around),
    )

    since = 0.0
    period = 0.0

    def begin(self) -> None:
        """Read `hz` and start the period."""
        self.since = self.context.now
        self.period = 1.0 / self.inputs["hz"]

    def is_due(self) -> bool:
        """Whether the period has passed."""
        return self.context.now - self.since >= self.period - CLOCK_SLACK

    def succeeded(self) -> None:
        """Start the period again."""
        self.since = self.context.now


class DistanceController(_Paced):
    """The child is due `distance` away from where it last succeeded or the node started."""

    spec = decorator(
        "DistanceController",
        "distance_controller",
        "Runs the child each time the robot has moved by `distance`.",
        input_port("distance", float, "how far", 1.0, "m", least=0),
        input_port("global_frame", str, "where it is measured", "odom"),
        input_port("robot_base_frame", str | None, "what is measured; the robot's base", None),
        dialect=Dialect.NAV2,
        flow=again(around),
        codes=and_also(FRAME_UNKNOWN),
    )

    origin: Array | None = None

    def begin(self) -> None:
        """Measure the distance from here."""
        self.origin = self._position()

    def is_due(self) -> bool:
        """Whether the robot has moved by `distance`."""
        here = self._position()
        if here is None or self.origin is None:
            return False
        distance: float = self.inputs["distance"]
        return math.dist(here, self.origin) >= distance

    def succeeded(self) -> None:
        """Measure the distance from here again."""
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
    """The child is due after a period that depends on the robot's speed.

    The rate rises from `min_rate` at `min_speed` to `max_rate` at `max_speed`. Each new period is
    computed when the previous one is over. When a goal changes, the child is due at once, and the
    next period is the shortest one.
    """

    spec = decorator(
        "SpeedController",
        "speed_controller",
        "Runs the child more often the faster the robot drives, and at each new goal.",
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
        """Start with the shortest period."""
        self.goals.remember()
        self._restart()

    def is_due(self) -> bool:
        """Whether the period has passed; if so, compute the next one from the speed."""
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
    """Runs the child to its end once; then returns FAILURE until the node is restarted."""

    spec = decorator(
        "SingleTrigger",
        "single_trigger",
        "Runs the child once, then fails until the node is restarted.",
        dialect=Dialect.NAV2,
        flow=around,
        around=lambda node: "once at each start",
    )

    triggered = False

    def step(self) -> Status:
        """Tick the child until it ends."""
        if self.state is IDLE:
            self.triggered = False
        self.state = RUNNING
        if self.triggered:
            return self.fail(FAILED, f"{self.child.name} has had its one run")
        status = self.child.execute()
        self.triggered = status.completed
        return self.pass_on(status)
