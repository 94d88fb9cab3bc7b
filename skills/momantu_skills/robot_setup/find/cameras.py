"""Which of a robot's cameras comes first: skills look with the first one."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Transform
from momantu_skills.robot_setup.find.arms import own_chain
from momantu_skills.robot_setup.find.fingers import Hand
from momantu_skills.robot_setup.find.sensors import FoundSensor
from momantu_skills.robot_setup.urdf.body import Body

OPTICAL_FROM_LINK = Transform.from_rpy((0.0, 0.0, 0.0), (-math.pi / 2, 0.0, -math.pi / 2))
"""An optical frame on a link whose x looks ahead and whose z is up."""
WITH_DEPTH = re.compile(r"rgb_?d|depth|kinect|realsense|xtion|astra|orbbec|(^|_)d4\d\d|zed", re.I)
"""Usual names of cameras that measure depth."""
STEREO = re.compile(r"stereo", re.IGNORECASE)
"""Usual names of cameras that measure depth with two eyes."""
WITHOUT_DEPTH = re.compile(
    r"(^|_)(left|right|l|r|wide|narrow|fish_?eye|infra\d?|high_def)(_|$)", re.I
)
"""Usual names of cameras that do not: one eye of two."""
LOW = 0.5
"""Height above the floor, m, below which a camera that nothing moves sees no table's top."""
ASIDE = math.radians(60.0)
"""Angle from straight ahead, rad, beyond which a camera that nothing moves looks elsewhere."""


def best_first(
    body: Body, sensors: Sequence[FoundSensor], hands: Sequence[Hand]
) -> list[FoundSensor]:
    """The same sensors, with the cameras among them in the order in which skills should use them.

    First those that can look at a table ahead: an arm or a head moves them, or they are high
    enough and look ahead. Of these those with depth, and of these those that a head moves.
    """
    arms = {joint for hand in hands for joint in own_chain(body, hand.palm)}

    def behind(camera: FoundSensor) -> tuple[bool, int, bool]:
        chain = own_chain(body, camera.link)
        return not chain and _blind(body, camera), _depth(camera), not set(chain) - arms

    cameras = iter(sorted((s for s in sensors if s.kind == "camera"), key=behind))
    return [next(cameras) if sensor.kind == "camera" else sensor for sensor in sensors]


def _depth(camera: FoundSensor) -> int:
    """Cameras with depth come before others."""
    if camera.depth or WITH_DEPTH.search(camera.link):
        return 0
    if STEREO.search(camera.link):
        return 2
    return 3 if WITHOUT_DEPTH.search(camera.link) else 1


def _blind(body: Body, camera: FoundSensor) -> bool:
    """Whether a camera that nothing moves is too low, or looks to a side."""
    base_from_camera = body.link_poses({}, [camera.link])[camera.link]
    if not camera.optical:
        base_from_camera = base_from_camera @ OPTICAL_FROM_LINK.matrix
    height = float(base_from_camera[2, 3]) - min(body.lowest({}), 0.0)
    x, y = base_from_camera[:2, 2]
    level = float(np.hypot(x, y))
    aside = level > math.cos(ASIDE) and abs(math.atan2(y, x)) > ASIDE
    return height < LOW or aside
