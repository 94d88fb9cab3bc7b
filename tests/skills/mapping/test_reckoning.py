"""A turn on the move is straightened by gyroscopes and wheels; gravity is found beneath it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.mapping.three_d.reckoning import Reckoning, straightened

from momantu_bt.geometry import Pose2D, Transform, quaternion_from_rpy
from momantu_bt.messages import ImuReading
from momantu_bt.motion import Motion
from tests.skills.mapping.halls import MOUNT, RING, SAMPLE, moments, turn_of


def reckoned(moment, reckoning):
    for stamp, odometry, imu in moment.odometry:
        reckoning.add(stamp, odometry, imu)


@settings(max_examples=25, deadline=None)
@given(st.floats(-1.0, 1.0), st.floats(-1.5, 1.5), st.floats(-math.pi, math.pi))
def test_a_straightened_turn_is_that_of_a_base_at_rest(speed, turning, yaw):
    step = Pose2D(speed * SAMPLE, 0.0, turning * SAMPLE)
    poses = [Pose2D(1.5, 1.5, yaw)]
    for _ in range(40):
        poses.append(poses[-1] @ step)
    reckoning = Reckoning(Transform())
    for moment in moments(poses, RING, drift=0.0, noise=0.0, bias=0.0):
        reckoned(moment, reckoning)
    found = straightened(
        moment.turn.points, moment.turn.times, moment.stamp, MOUNT, reckoning.motion
    )
    still = Motion.of([moment.stamp], [moment.truth])
    again = moment.truth.apply(found)
    beams = turn_of(still, moment.stamp, RING, 0, 0.0)
    assert len(found) > 0.95 * len(beams.points)
    assert _apart(again, RING) < 2e-3


def _apart(points, boxes):
    """The largest distance of points to the floor or to the faces of boxes, m."""
    best = np.abs(points[:, 2])
    for box in np.array(boxes):
        outside = np.maximum(np.maximum(box[:3] - points, points - box[3:]), 0.0)
        inside = np.minimum(points - box[:3], box[3:] - points).min(axis=1)
        far = np.linalg.norm(outside, axis=1)
        best = np.minimum(best, np.where(far > 0.0, far, np.abs(inside)))
    return best.max()


def test_the_gyroscopes_bias_is_learnt_at_rest():
    rest = [Pose2D(1.5, 1.5, 0.3)] * 150
    straight = [Pose2D(1.5 + 0.008 * i, 1.5, 0.3) for i in range(150)]
    reckoning = Reckoning(Transform())
    for moment in moments([*rest, *straight], RING, bias=0.02):
        reckoned(moment, reckoning)
        if moment.stamp < 1.3:
            rested = reckoning.newest
    assert rested.angle_to(reckoning.newest) < 0.1 * 0.02 * 1.5


def test_up_is_away_from_gravity_however_the_imu_is_mounted():
    mount = Transform((0.1, 0.0, 0.2), quaternion_from_rpy(math.pi, 0.0, 0.5))
    reckoning = Reckoning(mount)
    for moment in moments([Pose2D(1.5, 1.5, 0.0)] * 60, RING):
        for stamp, odometry, imu in moment.odometry:
            turned = ImuReading(
                imu.stamp, imu.frame, imu.times, imu.rates, imu.forces @ mount.rotation
            )
            reckoning.add(stamp, odometry, turned)
    assert reckoning.up == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)


def test_how_the_wheels_speed_up_is_no_tilt():
    reckoning, x = Reckoning(Transform()), 0.0
    for number in range(20):
        stamp, speed = number * 0.05, 1.0 * number * 0.05
        x = 0.5 * speed * stamp
        times = stamp - np.arange(5)[::-1] * 0.01
        forces = np.tile([1.0, 0.0, 9.81], (5, 1))
        reckoning.add(
            stamp,
            Transform((x, 0.0, 0.0)),
            ImuReading(stamp, "base_link", times, np.zeros((5, 3)), forces),
        )
    assert reckoning.up == pytest.approx([0.0, 0.0, 1.0], abs=0.01)


def test_a_bump_tells_nothing_of_gravity():
    reckoning = Reckoning(Transform())
    for number in range(10):
        times = number * 0.05 - np.arange(5)[::-1] * 0.01
        forces = np.tile([0.0, 0.0, 12.0], (5, 1))
        imu = ImuReading(number * 0.05, "base_link", times, np.zeros((5, 3)), forces)
        reckoning.add(number * 0.05, Transform(), imu)
    assert reckoning.up is None
