"""Covariances (6, 6) of poses: x, y, z in m, then small rotations about fixed axes, rad.

The order and the frame are those of PoseWithCovariance in ROS: both halves are along the axes of
the frame that the pose is in, not of the frame that it is the pose of.
"""

from __future__ import annotations

import cv2
import numpy as np

from momantu_bt.geometry import Array, Transform


def turned(covariance: Array, rotation: Array) -> Array:
    """The covariance of a_from_c from that of b_from_c; rotation (3, 3): of an exact a_from_b."""
    both = np.kron(np.eye(2), rotation)
    return np.asarray(both @ covariance @ both.T)


def inverted(covariance: Array, pose: Transform) -> Array:
    """The covariance of b_from_a from that of `pose`, a_from_b."""
    back = pose.rotation.T
    by = np.zeros((6, 6))
    by[:3, :3] = -back
    by[:3, 3:] = -back @ skew(pose.position)
    by[3:, 3:] = -back
    return np.asarray(by @ covariance @ by.T)


def at_arm(covariance: Array, arm: Array) -> Array:
    """The covariance of another point's pose on the same body, `arm` (3,) m away in these axes."""
    by = np.eye(6)
    by[:3, 3:] = -skew(arm)
    return np.asarray(by @ covariance @ by.T)


def moved(pose: Transform, step: Array) -> Transform:
    """The pose after a small step (6,), m and rad along the axes of its frame."""
    turn = Transform.from_rotation(cv2.Rodrigues(np.asarray(step[3:], dtype=np.float64))[0])
    return Transform(
        pose.position + step[:3], (turn @ Transform((0, 0, 0), pose.quaternion)).quaternion
    )


def difference(one: Transform, other: Transform) -> Array:
    """The step (6,) from one pose to another; the inverse of `moved`."""
    turn = Transform((0, 0, 0), other.quaternion) @ Transform((0, 0, 0), one.quaternion).inverse()
    vector = cv2.Rodrigues(turn.rotation)[0].ravel()
    return np.concatenate([other.position - one.position, vector])


def skew(vector: Array) -> Array:
    """The matrix (3, 3) that takes the cross product of a vector (3,) with another."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def as_port(covariance: Array) -> tuple[float, ...]:
    """A covariance as a port of a skill has it: 36 numbers, row by row."""
    return tuple(float(value) for value in covariance.ravel())
