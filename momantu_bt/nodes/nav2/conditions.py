"""Conditions of Nav2 about the goal, frames and motion."""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.outside import SPEED, TRANSFORM
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED, FRAME_UNKNOWN, Failure
from momantu_bt.messages import TrackingFeedback
from momantu_bt.nodes.goals import GOAL_NAMES, GOAL_PORTS, Goals, peek
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.spec import Dialect, input_port, leaf

HARDEST = -10.0
"""Deceleration beyond which the base has bumped into something, m/s2."""


class GlobalUpdatedGoal(TreeNode):
    """SUCCESS the first time, and whenever a goal has changed since this node last looked.

    Unlike `GoalUpdated`, it remembers the goal when it is halted.
    """

    spec = leaf(
        "GlobalUpdatedGoal",
        "global_updated_goal",
        "Succeeds the first time and when the goal has changed since it last looked.",
        *GOAL_PORTS,
        may_be_empty=GOAL_NAMES,
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.goals = Goals(parts.inputs(*GOAL_NAMES))
        self.looked = False

    def step(self) -> Status:
        """Compare the goal with the one that was there before."""
        first, self.looked = not self.looked, True
        changed = self.goals.have_changed()
        if first or changed:
            return SUCCESS
        return self.fail(FAILED, "the goal has not changed")


class InitialPoseReceived(TreeNode):
    """SUCCESS when a key is true; in Nav2 the navigator sets it."""

    spec = leaf(
        "InitialPoseReceived",
        "initial_pose_received",
        "Succeeds when $initial_pose_received is true.",
        input_port("initial_pose_received", bool, "whether the robot was told where it is", None),
        may_be_empty=("initial_pose_received",),
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs("initial_pose_received")

    def step(self) -> Status:
        """Read the key."""
        if peek(self.inputs, "initial_pose_received") is True:
            return SUCCESS
        return self.fail(FAILED, "no initial pose was received")


class TransformAvailable(TreeNode):
    """SUCCESS when the pose of one frame in another is known; from then on always."""

    spec = leaf(
        "TransformAvailable",
        "transform_available",
        "Succeeds when the pose of one frame in another is known.",
        input_port("child", str, "one frame"),
        input_port("parent", str, "the other frame"),
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.found = False

    def step(self) -> Status:
        """Look the frames up."""
        self.found = self.found or self.context.ask(TRANSFORM, self._known)
        if self.found:
            return SUCCESS
        return self.fail(FAILED, f"{self.inputs['child']} in {self.inputs['parent']} is not known")

    def _known(self) -> bool:
        body = self.context.body
        if body is None:
            return False
        try:
            body.frames.lookup(self.inputs["parent"], self.inputs["child"])
        except Failure as failure:
            if failure.value.code != FRAME_UNKNOWN:
                raise
            return False
        return True


class IsWithinPathTrackingBounds(TreeNode):
    """FAILURE when the base is too far from its path, or turned too far away from it.

    It succeeds as long as nothing was reported.
    """

    spec = leaf(
        "IsWithinPathTrackingBounds",
        "is_within_path_tracking_bounds",
        "Succeeds while the base is near its path.",
        input_port("max_error_left", float, "farthest to the left", 0.5, "m"),
        input_port("max_error_right", float, "farthest to the right", 0.5, "m"),
        input_port("max_error_heading", float, "largest turn away", 3.14, "rad"),
        input_port("tracking_feedback", TrackingFeedback | None, "how the base follows", None),
        may_be_empty=("tracking_feedback",),
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()

    def step(self) -> Status:
        """Compare the newest report."""
        told = peek(self.inputs, "tracking_feedback")
        if told is MISSING or told is None:
            return SUCCESS
        off, turned = told.position_tracking_error, told.heading_tracking_error
        most = abs(self.inputs["max_error_left" if off >= 0.0 else "max_error_right"])
        if abs(off) <= most and abs(turned) <= abs(self.inputs["max_error_heading"]):
            return SUCCESS
        side = "left" if off >= 0.0 else "right"
        return self.fail(
            FAILED,
            f"the base is {abs(off):.2f} m {side} of its path, turned by {turned:.2f} rad",
        )


class IsStuck(TreeNode):
    """SUCCESS when the base has lost speed faster than its brakes can: it bumped into something.

    It compares odometry between two ticks of this node.
    """

    spec = leaf(
        "IsStuck",
        "is_stuck",
        "Succeeds when the base stops harder than it can brake.",
        dialect=Dialect.NAV2,
        condition=True,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.last: tuple[float, float] | None = None

    def step(self) -> Status:
        """Compare the speed with the one before."""
        now, before = (self.context.now, self.context.ask(SPEED, self._speed)), self.last
        self.last = now
        if before is not None and now[0] > before[0]:
            change = (now[1] - before[1]) / (now[0] - before[0])
            if change < HARDEST:
                return SUCCESS
        return self.fail(FAILED, "the base has not stopped abruptly")

    def _speed(self) -> float:
        body = self.context.body
        return 0.0 if body is None else float(body.actuators.robot.state().linear)
