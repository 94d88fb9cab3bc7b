"""Bodies of revolution: centre and radii from an arc, wherever it stands and however it is seen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.geometry.revolution import fit_revolution

NOISE = 0.0012
"""m; of depth at 0.9 m."""


def arc(
    seed: int, radius: float, spread: float, bearing: float = 0.0, taper: float = 0.0
) -> np.ndarray:
    """Points on a body 0.12 m high, within `spread` rad of `bearing` as seen from its axis."""
    random = np.random.default_rng(seed)
    angles = bearing + random.uniform(-spread, spread, 500)
    heights = random.uniform(0.01, 0.12, 500)
    radii = radius + taper * heights + NOISE * random.standard_normal(500)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles), heights])


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 1000),
    st.floats(0.02, 0.08),
    st.floats(0.9, 1.4),
    st.floats(-3.0, 3.0),
    st.floats(-5.0, 5.0),
)
def test_an_arc_gives_centre_and_radius_wherever_it_stands(
    seed: int, radius: float, spread: float, bearing: float, x: float
) -> None:
    points = arc(seed, radius, spread, bearing) + np.array([x, 1.0, 0.0])
    body = fit_revolution(points)
    assert body is not None
    assert np.hypot(*(body.centre - (x, 1.0))) < 0.003
    assert body.radius == pytest.approx(radius, abs=0.003)
    assert body.misfit == pytest.approx(0.67 * NOISE, rel=0.35)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.floats(-0.25, 0.25))
def test_a_tapering_body_has_a_radius_per_slice(seed: int, taper: float) -> None:
    body = fit_revolution(arc(seed, 0.05, 1.3, taper=taper))
    assert body is not None
    known = ~np.isnan(body.radii)
    assert body.radii[known] == pytest.approx(0.05 + taper * body.heights[known], abs=0.004)
    assert np.hypot(*body.centre) < 0.003


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.floats(0.25, 0.5))
def test_a_known_radius_makes_a_narrow_arc_enough(seed: int, spread: float) -> None:
    points = arc(seed, 0.035, spread)
    body = fit_revolution(points, radius=0.035)
    assert body is not None
    assert np.hypot(*body.centre) < 0.004
    assert body.radius == 0.035


def test_a_handle_does_not_move_the_axis() -> None:
    handle = np.column_stack(
        [np.full(40, 0.055), np.linspace(-0.005, 0.005, 40), np.linspace(0.03, 0.09, 40)]
    )
    body = fit_revolution(np.concatenate([arc(1, 0.04, 1.3), handle]))
    assert body is not None
    assert np.hypot(*body.centre) < 0.002


def test_a_wider_arc_is_surer() -> None:
    narrow, wide = fit_revolution(arc(2, 0.035, 0.6)), fit_revolution(arc(2, 0.035, 1.4))
    assert narrow is not None
    assert wide is not None
    assert narrow.radius_sigma > 2 * wide.radius_sigma


def test_few_points_make_no_body() -> None:
    assert fit_revolution(arc(0, 0.03, 1.0)[:8]) is None
