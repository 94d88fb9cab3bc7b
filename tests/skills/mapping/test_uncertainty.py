"""Along a bare wall the pose gets as uncertain as odometry is, and no more."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.mapping.uncertainty import Uncertainty
from momantu_skills.navigation.config import LocalizationConfig
from momantu_skills.navigation.localize.confidence import sigmas
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.tracking import FLOOR, Tracked

from momantu_bt.geometry import Pose2D

CONFIG = LocalizationConfig()
STEP = Pose2D(0.1, 0.0, 0.0)
MOTIONS = st.builds(Pose2D, st.floats(-0.2, 0.2), st.floats(-0.1, 0.1), st.floats(-0.3, 0.3))


def _tracked(*sigma: float) -> Tracked:
    return Tracked(ORIGIN, np.diag(np.square(sigma)) + FLOOR, 1.0)


SHARP = _tracked(0.005, 0.005, 0.001)
WALL = _tracked(10.0, 0.005, 0.002)
"""A wall to the left, without an end."""


def _after(*steps: tuple[Pose2D, Tracked]) -> Uncertainty:
    uncertainty = Uncertainty(CONFIG)
    uncertainty.follow(ORIGIN, SHARP)
    for motion, tracked in steps:
        uncertainty.follow(motion, tracked)
    return uncertainty


@pytest.mark.parametrize("metres", [1, 5, 20])
def test_along_a_bare_wall_it_grows_as_odometrys_error_does(metres: int) -> None:
    found = _after(*[(STEP, WALL)] * (10 * metres)).covariance
    expected = CONFIG.translation_noise * 0.1 * math.sqrt(10 * metres)
    assert math.sqrt(found[0, 0]) == pytest.approx(expected, rel=0.4)
    assert math.sqrt(found[1, 1]) < 0.02


def test_a_corner_ends_it() -> None:
    position, yaw = sigmas(_after(*[(STEP, WALL)] * 100, (STEP, SHARP)).covariance)
    assert position < 0.02
    assert yaw < 0.01


def test_scans_that_show_nothing_leave_odometry() -> None:
    lost = _tracked(10.0, 10.0, 10.0)
    position, yaw = sigmas(_after(*[(STEP, lost)] * 20).covariance)
    assert 0.02 < position < 0.3
    assert yaw == pytest.approx(CONFIG.turn_per_metre * 0.1 * math.sqrt(20), rel=0.3)


def test_at_rest_nothing_grows() -> None:
    first = _after(*[(STEP, WALL)] * 30).covariance
    assert sigmas(_after(*[(STEP, WALL)] * 30, *[(ORIGIN, WALL)] * 50).covariance)[0] <= (
        sigmas(first)[0] + 1e-9
    )


def test_after_a_turn_the_doubt_lies_to_the_side() -> None:
    along = _after(*[(STEP, WALL)] * 100).covariance
    turned = _after(
        *[(STEP, WALL)] * 100, (Pose2D(0.0, 0.0, math.pi / 2), _tracked(0.01, 10.0, 0.002))
    ).covariance
    assert turned[1, 1] == pytest.approx(along[0, 0], rel=0.1)
    assert turned[0, 0] < 0.02**2


@given(st.lists(st.tuples(MOTIONS, st.sampled_from([SHARP, WALL])), max_size=30))
def test_it_is_a_covariance_never_below_what_cells_leave(steps) -> None:
    found = _after(*steps).covariance
    assert np.allclose(found, found.T, atol=1e-9)
    assert (np.linalg.eigvalsh(found - FLOOR) > -1e-9).all()
