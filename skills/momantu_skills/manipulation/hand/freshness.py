"""Whether a measured pose is recent enough to touch the object."""

from __future__ import annotations

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Pose
from momantu_skills.manipulation.config import HandConfig


def check_fresh(pose: Pose, what: str, now: float, last_contact: float, config: HandConfig) -> None:
    """Reject poses in another frame, too old, or older than the last contact.

    Raises:
        Failure: STALE_POSE; its sentence says which of these it is.
    """
    if pose.frame != ODOM:
        raise Failure(
            "STALE_POSE",
            f"the pose of the {what} is given in {pose.frame!r}; what is touched must be in 'odom'",
        )
    age = now - pose.stamp
    if age > config.old_pose:
        raise Failure(
            "STALE_POSE",
            f"the {what} was seen {age:.0f} s ago, at most {config.old_pose:.0f} s are trusted",
            age=age,
        )
    if pose.stamp < last_contact:
        raise Failure(
            "STALE_POSE",
            f"the {what} was seen before the hand last touched something: look again",
            age=age,
        )
