"""TimeExpired, DistanceTraveled, PathExpiringTimer, CheckStopStatus: conditions with a memory.

Time is that of the world's clock.
"""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.outside import TURNING
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.status import IDLE, RUNNING, SUCCESS, Status
from momantu_bt.failure import FAILED, FRAME_UNKNOWN
from momantu_bt.geometry import Path, Pose2D
from momantu_bt.nodes.goals import peek
from momantu_bt.nodes.nav2.pose import BASE_FRAME, GLOBAL_FRAME, robot_pose
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.codes import and_also
from momantu_bt.tree.catalogue.spec import Dialect, input_port, leaf


class TimeExpired(TreeNode):
    """FAILURE until `seconds` have passed since the start; then SUCCESS, and it starts again."""

    spec = leaf(
        "TimeExpired",
        "time_expired",
        "Succeeds when a time has passed since it was first asked, or last succeeded.",
        input_port("seconds", float, "how long", 1.0, "s", least=0),
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.since = 0.0

    def step(self) -> Status:
        """Compare the time."""
        now = self.context.now
        if self.state is IDLE:
            self.since = now
        elif now - self.since >= self.inputs["seconds"] - CLOCK_SLACK:
            self.since = now
            return SUCCESS
        return self.fail(FAILED, f"{now - self.since:.1f} s have passed")


class DistanceTraveled(TreeNode):
    """FAILURE until the robot is `distance` away from where it started; then it starts again."""

    spec = leaf(
        "DistanceTraveled",
        "distance_traveled",
        "Succeeds when the robot has moved by a distance since it was first asked, or succeeded.",
        input_port("distance", float, "how far", 1.0, "m", least=0),
        GLOBAL_FRAME,
        BASE_FRAME,
        dialect=Dialect.NAV2,
        condition=True,
        codes=and_also(FRAME_UNKNOWN),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.origin: Pose2D | None = None

    def step(self) -> Status:
        """Compare the place."""
        frame, base = self.inputs["global_frame"], self.inputs["robot_base_frame"]
        here = robot_pose(self.context, frame, base)
        if self.state is IDLE or self.origin is None:
            self.origin = here
        way = here.distance_to(self.origin)
        if self.state is not IDLE and way >= self.inputs["distance"]:
            self.origin = here
            return SUCCESS
        return self.fail(FAILED, f"the robot is {way:.2f} m away")


class PathExpiringTimer(TreeNode):
    """FAILURE until a path is `seconds` old; then SUCCESS, and it counts again.

    The path's age counts from when this node first saw it, and goes on while the node is halted.
    """

    spec = leaf(
        "PathExpiringTimer",
        "path_expiring_timer",
        "Succeeds when a path has not been replaced for a time.",
        input_port("seconds", float, "how long", 1.0, "s", least=0),
        input_port("path", tuple[Pose2D, ...], "the path", None),
        may_be_empty=("path",),
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.path: Any = MISSING
        self.since: float | None = None

    def step(self) -> Status:
        """Compare the path's age."""
        now, path = self.context.now, self._path()
        first = self.since is None
        if self.since is None or path != self.path:
            self.path, self.since = path, now
        age = now - self.since
        if first or age < self.inputs["seconds"] - CLOCK_SLACK:
            return self.fail(FAILED, f"the path is {age:.1f} s old")
        self.since = now
        return SUCCESS

    def _path(self) -> Path | None:
        path = peek(self.inputs, "path")
        return None if path is MISSING else path


class CheckStopStatus(TreeNode):
    """RUNNING while the robot stands, SUCCESS after it has stood long enough, FAILURE if it moves.

    A moving robot fails the node, as in Nav2.
    """

    spec = leaf(
        "CheckStopStatus",
        "check_stop_status",
        "Waits until the robot has stood still for a time; fails while it moves.",
        input_port("velocity_threshold", float, "largest speed, m/s and rad/s", 0.01, "m/s"),
        input_port("duration_stopped", int, "how long, in milliseconds", 1000, least=0),
        dialect=Dialect.NAV2,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.since: float | None = None

    def step(self) -> Status:
        """Measure the speed."""
        linear, angular = self.context.ask(TURNING, self._speeds)
        least: float = self.inputs["velocity_threshold"]
        now = self.context.now
        if abs(linear) >= least or abs(angular) >= least:
            self.since = None
            return self.fail(FAILED, f"the robot moves: {linear:.2f} m/s, {angular:.2f} rad/s")
        self.since = now if self.since is None else self.since
        if now - self.since > self.inputs["duration_stopped"] / 1000:
            self.since = None
            return SUCCESS
        return RUNNING

    def clear(self) -> None:
        """Forget since when it stands."""
        self.since = None

    def _speeds(self) -> tuple[float, float]:
        body = self.context.body
        if body is None:
            return (0.0, 0.0)
        state = body.actuators.robot.state()
        return (float(state.linear), float(state.angular))
