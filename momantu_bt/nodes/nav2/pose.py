"""Where the robot is, as the nodes of Nav2 ask for it: through the run, so that replays answer."""

from __future__ import annotations

import numpy as np

from momantu_bt.engine.context import RunContext
from momantu_bt.engine.outside import POSE
from momantu_bt.failure import FRAME_UNKNOWN, Failure
from momantu_bt.frames import MAP
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.tree.catalogue.spec import input_port

BASE_FRAME = input_port("robot_base_frame", str | None, "what is located; the robot's base", None)
GLOBAL_FRAME = input_port("global_frame", str, "where it is located", MAP)


def robot_pose(context: RunContext, frame: str = MAP, base: str | None = None) -> Pose2D:
    """The robot's pose in a frame.

    Raises:
        Failure: FRAME_UNKNOWN: there is no world, or no such frame.
    """

    def now() -> Array:
        body = context.body
        if body is None:
            raise Failure(FRAME_UNKNOWN, "without a world the robot stands nowhere")
        link = base or body.actuators.robot.description.base_frame
        pose = Pose2D.from_transform(body.frames.lookup(frame, link))
        return np.array([pose.x, pose.y, pose.yaw])

    x, y, yaw = context.ask(POSE, now)
    return Pose2D(float(x), float(y), float(yaw))
