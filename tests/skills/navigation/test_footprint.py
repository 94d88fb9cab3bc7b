"""Discs cover a footprint and hardly stick out of it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.control.footprint import SLACK, SPACING, discs, half_width


@st.composite
def _outlines(draw: st.DrawFn) -> np.ndarray:
    """Convex outlines: points of an ellipse, shifted, counter-clockwise."""
    count = draw(st.integers(4, 12))
    a, b = draw(st.floats(0.15, 0.5)), draw(st.floats(0.15, 0.5))
    angles = np.arange(count) * 2 * math.pi / count + draw(st.floats(0, 0.5))
    return np.stack([a * np.cos(angles) + 0.1, b * np.sin(angles)], axis=1)


def _depth(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    sides = np.roll(outline, -1, axis=0) - outline
    normals = np.stack([-sides[:, 1], sides[:, 0]], axis=1) / np.hypot(*sides.T)[:, None]
    return ((points[:, None] - outline[None]) * normals[None]).sum(axis=2).min(axis=1)


@settings(max_examples=30)
@given(_outlines())
def test_discs_stay_within_the_slack(outline: np.ndarray) -> None:
    found = discs(outline)
    assert (found[:, 2] <= _depth(outline, found[:, :2]) + SLACK + 1e-9).all()


@settings(max_examples=30)
@given(_outlines())
def test_discs_cover_the_inside(outline: np.ndarray) -> None:
    found = discs(outline)
    inside = np.stack(np.meshgrid(*[np.arange(-0.6, 0.8, 0.03)] * 2), axis=-1).reshape(-1, 2)
    inside = inside[_depth(outline, inside) > SPACING]
    away = np.hypot(*(inside[:, None] - found[None, :, :2]).transpose(2, 0, 1)) - found[None, :, 2]
    assert away.min(axis=1).max() < 1.5 * SPACING


def test_a_round_base_is_few_discs() -> None:
    angles = np.arange(24) * math.pi / 12
    assert len(discs(0.3 * np.stack([np.cos(angles), np.sin(angles)], axis=1))) <= 2


def test_half_width_is_to_the_side() -> None:
    assert half_width(np.array([(0.5, 0.1), (-0.2, 0.3), (-0.2, -0.1)])) == pytest.approx(0.3)


def test_a_clockwise_outline_is_refused() -> None:
    with pytest.raises(ValueError, match="counter-clockwise"):
        discs(np.array([(0.2, 0.2), (0.2, -0.2), (-0.2, -0.2), (-0.2, 0.2)]))
