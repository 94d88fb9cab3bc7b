"""Light and noise of pictures: more noise needs more pictures, until it is too dark."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_skills.perception.light import (
    MOST_PICTURES,
    Brightness,
    brightness,
    levels,
    lift_of,
    light_of,
)
from numpy.typing import NDArray


def noisy(level: float, sigma: float, seed: int = 0) -> NDArray[np.uint8]:
    """A picture of stripes with noise."""
    random = np.random.default_rng(seed)
    stripes = np.where(np.arange(320) // 40 % 2, level, 1.2 * level)
    picture = stripes + sigma * random.standard_normal((240, 320))
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("sigma", [2.0, 5.0, 10.0, 20.0])
def test_noise_is_measured_beside_edges(sigma: float) -> None:
    assert brightness(noisy(120.0, sigma)).noise == pytest.approx(sigma, rel=0.1)


def test_darker_and_noisier_pictures_need_more_until_it_is_too_dark() -> None:
    seen = [brightness(noisy(*told)) for told in [(120, 2), (60, 9), (40, 12), (25, 14), (4, 9)]]
    counts = [each.pictures for each in seen]
    assert counts == sorted(counts)
    assert counts[0] == 1
    assert counts[-1] == MOST_PICTURES
    assert [each.too_dark for each in seen] == [False, False, False, False, True]
    assert Brightness(0.0, 0.0, 0.0).too_dark


def test_averaged_light_is_less_noisy() -> None:
    one, many = (light_of([noisy(60, 9, seed) for seed in range(count)]) for count in (1, 16))
    assert one[:, :40].std() > 3.5 * many[:, :40].std()


def test_dim_pictures_are_lifted_and_others_are_not() -> None:
    dim, clear = light_of([noisy(30, 1)]), light_of([noisy(150, 1)])
    lift = lift_of(dim)
    assert lift is not None
    assert np.median(levels(dim, lift)) == pytest.approx(128, abs=4)
    assert lift_of(clear) is None
