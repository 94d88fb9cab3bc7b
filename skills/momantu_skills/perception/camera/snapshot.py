"""Taking a picture, with the pose of its camera."""

from __future__ import annotations

from momantu_bt.frames import ODOM, FrameBuffer
from momantu_bt.robot import Robot, read_camera
from momantu_bt.service import Snapshot


def take(robot: Robot, frames: FrameBuffer) -> Snapshot:
    """Read the robot's first camera and look up where it was at the picture's stamp.

    Raises:
        Failure: SENSOR_DEAD, or FRAME_UNKNOWN where the stamp is older than the buffer.
    """
    image = read_camera(robot)
    return Snapshot(
        image,
        frames.lookup(ODOM, image.frame, image.stamp),
        frames.lookup(ODOM, robot.description.base_frame, image.stamp),
        robot.state(),
    )
