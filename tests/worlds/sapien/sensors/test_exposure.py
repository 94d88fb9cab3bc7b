"""Exposure: time before gain, noise that gain amplifies, and the usual setting in good light."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sapien.sensors.exposure import AIM, expose, metered, well_lit
from numpy.typing import NDArray
from pydantic import ValidationError

from momantu_bt.robot_parts import Exposure

USUAL = Exposure()


def gray(light: float) -> NDArray[np.float32]:
    return np.full((64, 64, 3), light, dtype=np.float32)


def taken(light: float, seed: int = 0) -> NDArray[np.uint8]:
    """A gray picture with the exposure that it gets."""
    return expose(gray(light), metered(gray(light), USUAL), np.random.default_rng(seed))


@pytest.mark.parametrize(("value", "well"), [(30, False), (90, True), (150, True), (250, False)])
def test_good_light_keeps_the_usual_exposure(value: int, well: bool) -> None:
    assert well_lit(np.full((8, 8, 4), value, dtype=np.uint8)) is well


@given(st.floats(1e-6, 20.0))
def test_time_comes_before_gain_and_both_stay_within_their_limits(light: float) -> None:
    setting = metered(gray(light), USUAL)
    longest = USUAL.longest / USUAL.usual
    assert 0.0 < setting.time <= longest * (1 + 1e-9)
    assert 1.0 <= setting.gain <= USUAL.most_gain * (1 + 1e-9)
    assert setting.gain == pytest.approx(1.0) or setting.time == pytest.approx(longest)


@pytest.mark.parametrize("light", [0.004, 0.02, 0.05, 3.0])
def test_the_picture_becomes_middle_gray_in_any_light_within_the_limits(light: float) -> None:
    level = 255.0 * AIM ** (1 / 2.2)
    assert float(taken(light).mean()) == pytest.approx(level, abs=3.0)


def test_less_light_is_noisier_and_beyond_the_limits_darker() -> None:
    spread = [float(taken(light).std()) for light in (3.0, 0.05, 0.02, 0.005)]
    assert spread == sorted(spread)
    assert spread[-1] > 2.5 * spread[0]
    assert taken(0.0005).mean() < 0.6 * taken(0.005).mean()


def test_a_brighter_thing_saturates_and_a_seed_repeats_the_picture() -> None:
    light = gray(0.01)
    light[:8, :8] = 5.0
    picture = expose(light, metered(gray(0.01), USUAL), np.random.default_rng(1))
    assert (picture[:8, :8] == 255).all()
    assert (taken(0.01, 3) == taken(0.01, 3)).all()
    assert (taken(0.01, 3) != taken(0.01, 4)).any()


def test_a_longest_exposure_below_the_usual_one_is_refused() -> None:
    with pytest.raises(ValidationError, match=r"0\.004 s, is shorter than the usual one, 0\.008 s"):
        Exposure(longest=0.004)
