"""What still moves of a robot whose run is over."""

from __future__ import annotations

from momantu_bt.world import Incident
from momantu_worlds.scenes.referee.ground_truth import GroundTruth
from momantu_worlds.scenes.referee.hand import Hand

LINEAR, ANGULAR = 0.02, 0.05
"""m/s and rad/s; what is slower rests."""


def still_moving(truth: GroundTruth, hand: Hand, now: float) -> list[Incident]:
    """An incident for the base and for each joint of arm and gripper that moves; value: speed."""
    linear, angular = truth.base_speed()
    speeds = [("the base", linear, True), ("the base", angular, False)]
    speeds += [
        (name, joint.speed, joint.linear)
        for name, joint in truth.joint_speeds().items()
        if name in hand.joints
    ]
    return [
        Incident(
            now,
            "moving",
            f"{what} still moves at {speed:.2f} {'m/s' if slides else 'rad/s'}",
            speed,
        )
        for what, speed, slides in speeds
        if speed > (LINEAR if slides else ANGULAR)
    ]
