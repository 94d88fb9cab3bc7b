"""KLD sampling draws by weight, and as many as the spread asks for."""

import numpy as np
import pytest
from momantu_skills.navigation.localize.particle_filter import kld_resample


def _draw(poses: np.ndarray, weights: np.ndarray, most: int = 20_000, seed: int = 0) -> np.ndarray:
    uniforms = np.random.default_rng(seed).random(most)
    chosen: np.ndarray = kld_resample(
        poses, weights / weights.sum(), uniforms, 400, 0.1, 0.1, 0.05, 2.33
    )
    return chosen


def _cloud(sigma: float, count: int = 5000) -> np.ndarray:
    return np.random.default_rng(1).normal(size=(count, 3)) * sigma


def test_a_sure_belief_needs_the_fewest() -> None:
    assert len(_draw(_cloud(0.01), np.ones(5000))) == 400


def test_a_wider_belief_needs_more() -> None:
    counts = [len(_draw(_cloud(sigma), np.ones(5000))) for sigma in (0.02, 0.1, 0.3, 1.0)]
    assert counts == sorted(counts)
    assert counts[-1] > 3 * counts[0]


def test_never_more_than_allowed() -> None:
    assert len(_draw(_cloud(2.0), np.ones(5000), most=700)) == 700


def test_drawn_in_proportion_to_weight() -> None:
    weights = np.array([1.0, 2.0, 0.0, 5.0])
    chosen = _draw(np.zeros((4, 3)), weights, seed=3)
    shares = np.bincount(chosen, minlength=4) / len(chosen)
    assert shares[2] == 0.0
    assert shares == pytest.approx(weights / 8.0, abs=0.08)
