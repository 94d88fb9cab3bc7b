"""Hand-eye estimation: exact on exact data, accurate under noise, unmoved by wrong views."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.hand_eye.closed_form import METHODS, closed_form
from momantu_skills.calibration.hand_eye.estimate import JOINT, estimate, rough, solve
from momantu_skills.calibration.hand_eye.noise import PLACES
from momantu_skills.calibration.hand_eye.readings import Reading, better_reading
from momantu_skills.calibration.hand_eye.refine import refine, scale_of_target
from momantu_skills.calibration.hand_eye.spread import check_spread
from momantu_skills.calibration.hand_eye.views import Views
from momantu_skills.calibration.poses import Poses, quaternions, rotations_of_quaternions

from momantu_bt.geometry import Transform
from tests.skills.scenery.eyes import SHIFT, TURN, errors, noisy_hand, views

SETUPS = range(30)


@pytest.mark.parametrize("method", METHODS)
def test_closed_forms_are_exact_on_exact_data(method: str) -> None:
    for seed in range(10):
        exact, true, _ = views(seed)
        found = closed_form(exact, method)
        assert found is not None
        assert errors(found.eye, true.eye) == pytest.approx((0.0, 0.0), abs=1e-6)
        assert errors(found.target, true.target) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_the_joint_refinement_is_exact_on_exact_data() -> None:
    for seed in range(5):
        exact, true, _ = views(seed)
        found = solve(exact, 0)
        assert errors(found.mounting.eye, true.eye) == pytest.approx((0.0, 0.0), abs=1e-6)
        assert not found.outliers.any()


@pytest.mark.parametrize("wrong", [0, 3, 4])
def test_noise_and_wrong_views(wrong: int) -> None:
    off, found_all = [], 0
    for seed in SETUPS:
        noisy, true, chosen = views(seed, 17, TURN, SHIFT, wrong)
        found = solve(noisy, seed)
        off.append(errors(found.mounting.eye, true.eye))
        found_all += set(np.flatnonzero(found.outliers)) == set(chosen)
    angle, distance = np.median(off, axis=0)
    assert angle < 0.15
    assert distance < 1.2
    assert np.max(off, axis=0)[0] < 0.5
    assert np.max(off, axis=0)[1] < 6.0
    assert found_all >= len(SETUPS) - 2


def test_wrong_views_change_the_result_as_little_as_leaving_them_out() -> None:
    for seed in range(5):
        noisy, _, chosen = views(seed, 17, TURN, SHIFT, 3)
        without = noisy[np.setdiff1d(np.arange(17), chosen)]
        away = errors(solve(noisy, 0).mounting.eye, solve(without, 0).mounting.eye)
        assert away == pytest.approx((0.0, 0.0), abs=1e-3)


def test_the_joint_refinement_beats_the_closed_forms() -> None:
    off: dict[str, list[float]] = {name: [] for name in (*METHODS, JOINT)}
    for seed in range(11):
        noisy, true, _ = views(seed, 17, TURN, SHIFT)
        off[JOINT].append(errors(solve(noisy, 0).mounting.eye, true.eye)[1])
        for name in METHODS:
            found = closed_form(noisy, name)
            assert found is not None
            off[name].append(errors(found.eye, true.eye)[1])
    medians = {name: float(np.median(each)) for name, each in off.items()}
    assert min(medians, key=lambda name: medians[name]) == JOINT


def test_standard_deviations_are_those_of_the_errors() -> None:
    squares = []
    for seed in range(20):
        noisy, true, _ = views(seed, 17, TURN, SHIFT)
        found = solve(noisy, 0)
        apart = found.mounting.eye.position - true.eye.position
        squares.append(apart @ np.linalg.solve(found.covariance[3:6, 3:6], apart))
    assert 2.0 < np.mean(squares) < 4.5  # chi-squared of three degrees has the mean 3


def test_noise_is_told_by_where_it_acts() -> None:
    """A turn of the hand moves the target, which tells the mounting twice as exactly."""
    plain, weighed, shares = [], [], []
    for seed in range(12):
        exact, true, _ = views(seed)
        noisy = noisy_hand(exact, seed, TURN, SHIFT)
        start = rough(noisy, 0)
        found = refine(noisy, start)
        plain.append(errors(start.mounting.eye, true.eye)[1])
        weighed.append(errors(found.mounting.eye, true.eye)[1])
        shares.append(found.noise.shares)
        assert found.noise.rotation == pytest.approx(TURN / np.sqrt(3.0), rel=0.4)
    assert np.median(weighed) < 0.6 * np.median(plain)
    assert PLACES[int(np.argmax(np.mean(shares, axis=0)))] == "carrier"


@pytest.mark.parametrize("kind", ["mirrored", "another tag"])
def test_views_that_are_wrong_in_the_same_way_are_found(kind: str) -> None:
    """Five of 17, all off by the same transform: they agree with each other."""
    off = {
        "mirrored": Transform((0.16, 0.1, 0.0), (0.0, 0.0, 0.0, 1.0)),
        "another tag": Transform((0.1, -0.2, 0.1), (0.8, 0.2, -0.5, 0.1)),
    }[kind]
    for seed in range(6):
        noisy, true, _ = views(seed, 17, TURN, SHIFT)
        seen, wrong = noisy.camera_from_target, np.arange(2, 17, 3)
        bad = seen[wrong] @ Poses.of([off])
        seen.rotations[wrong], seen.positions[wrong] = bad.rotations, bad.positions
        found = solve(noisy, seed)
        assert list(np.flatnonzero(found.outliers)) == list(wrong)
        assert errors(found.mounting.eye, true.eye)[1] < 3.0


def test_the_estimate_has_every_method_on_views_held_back() -> None:
    noisy, _, _ = views(1, 17, TURN, SHIFT)
    found = estimate(noisy, 0)
    assert [method.name for method in found.methods] == [*METHODS, JOINT]
    assert all(0 < method.rotation < 0.02 and method.position < 0.01 for method in found.methods)


def test_a_wrong_size_of_the_squares_shows() -> None:
    noisy, _, _ = views(2, 17, TURN, SHIFT)
    scale, deviation = scale_of_target(noisy, solve(noisy, 0))
    assert abs(scale - 1.0) < 4 * deviation < 0.02
    seen = noisy.camera_from_target
    shrunk = Views(noisy.outer, Poses(seen.rotations, 0.9 * seen.positions))
    scale, deviation = scale_of_target(shrunk, solve(shrunk, 0))
    assert scale == pytest.approx(1 / 0.9, abs=0.02)
    assert scale - 1 > 4 * deviation


def scaled(poses: Poses, factor: float) -> Poses:
    return Poses(poses.rotations, poses.positions * factor)


def w_first(poses: Poses) -> Poses:
    """As if a file with w first was read as one with w last."""
    w, x, y, z = quaternions(poses.rotations).T
    return Poses(rotations_of_quaternions(np.column_stack([z, w, x, y])), poses.positions)


def mirrored(poses: Poses) -> Poses:
    """In frames whose y is turned over, as left-handed ones have it."""
    mirror = np.diag([1.0, -1.0, 1.0])
    return Poses(mirror @ poses.rotations @ mirror, poses.positions @ mirror)


def turned_back(poses: Poses) -> Poses:
    return Poses(np.swapaxes(poses.rotations, -1, -2), poses.positions)


def test_files_that_are_read_wrongly_are_recognised() -> None:
    good, _, _ = views(3, 17, TURN, SHIFT, 3)
    hand, seen = good.outer, good.camera_from_target
    assert better_reading(good, 0) is None
    for reading, given in {
        Reading.HAND_INVERTED: Views(hand.inverse(), seen),
        Reading.TARGET_INVERTED: Views(hand, seen.inverse()),
        Reading.HAND_MILLIMETRES: Views(scaled(hand, 1e3), seen),
        Reading.TARGET_MILLIMETRES: Views(hand, scaled(seen, 1e3)),
        Reading.HAND_CENTIMETRES: Views(scaled(hand, 1e2), seen),
        Reading.TARGET_CENTIMETRES: Views(hand, scaled(seen, 1e2)),
        Reading.MIRRORED: Views(hand, mirrored(seen)),
        Reading.HAND_TURNED_BACK: Views(turned_back(hand), seen),
        Reading.TARGET_TURNED_BACK: Views(hand, turned_back(seen.inverse()).inverse()),
        Reading.HAND_W_FIRST: Views(w_first(hand), seen),
        Reading.TARGET_W_FIRST: Views(hand, w_first(seen.inverse()).inverse()),
        Reading.BOTH_W_FIRST: Views(w_first(hand), w_first(seen)),
    }.items():
        assert better_reading(given, 0) is reading


def test_turns_about_one_axis_do_not_tell_the_mounting() -> None:
    good, _, _ = views(4)
    angles = np.linspace(-1.0, 1.0, 17)
    about_z = np.column_stack([np.cos(angles / 2), *np.zeros((2, 17)), np.sin(angles / 2)])
    outer = Poses(rotations_of_quaternions(about_z), good.outer.positions)
    with pytest.raises(CalibrationError, match=r"one axis only, \(0.00, 0.00, 1.00\) of the hand"):
        check_spread(outer, "hand")


def test_views_that_do_not_turn_tell_nothing() -> None:
    good, _, _ = views(5)
    outer = Poses(np.tile(np.eye(3), (17, 1, 1)), good.outer.positions)
    with pytest.raises(CalibrationError, match="all views are alike"):
        check_spread(outer, "hand")


def test_views_that_do_not_belong_together_are_refused() -> None:
    one, other = views(6)[0], views(7)[0]
    with pytest.raises(
        CalibrationError, match="the files do not fit together: half of the 17 views"
    ):
        estimate(Views(one.outer, other.camera_from_target), 0)


def test_too_few_views() -> None:
    with pytest.raises(CalibrationError, match="4 different views; at least 5 are needed"):
        estimate(views(8, 4)[0], 0)
