"""What a picture shows of a thing that was set down: where it stands, though beside its spot."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.hand.verification import (
    INSIDE,
    KNOWN,
    THIN,
    beside,
    standing,
    unseen_before,
)
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.messages import DetectedObject

TABLE = 0.7
CAN = DetectedObject(
    "can", Pose(Transform(), "odom", 0.0), (0.07, 0.07, 0.13), "cylinder", 1, TABLE
)
CARTON = DetectedObject("box", Pose(Transform(), "odom", 0.0), (0.06, 0.09, 0.18), "box", 1, TABLE)
THINGS = st.sampled_from([CAN, CARTON])
TURNS = st.floats(-3.1, 3.1)


def spot_of(thing: DetectedObject, x: float = 0.8, y: float = 0.1, yaw: float = 0.4) -> Transform:
    turn = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    return Transform((x, y, TABLE + thing.size[2] / 2), turn)


def face(thing: DetectedObject, pose: Transform, eye: tuple[float, float] = (0.0, 0.0)) -> Array:
    """Points of an upright thing that a camera at `eye` sees: its near sides, and its top."""
    x, y, z = np.array(thing.size) / 2
    heights = np.arange(-z, z + 1e-9, 0.006)
    if thing.shape == "cylinder":
        turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
        normals = np.column_stack([np.cos(turn), np.sin(turn)])
        rim = x * normals
    else:
        along = np.linspace(-1, 1, 16)
        ends = [(i * x, t * y, i, 0) for i in (-1, 1) for t in along]
        ends += [(t * x, i * y, 0, i) for i in (-1, 1) for t in along]
        rim, normals = np.array(ends)[:, :2], np.array(ends)[:, 2:]
    own_eye = pose.inverse().apply((*eye, pose.position[2]))[:2]
    rim = rim[np.einsum("ij,ij->i", own_eye - rim, normals) > 0]
    sides = np.vstack([np.column_stack([rim, np.full(len(rim), h)]) for h in heights])
    top = np.vstack([np.column_stack([s * rim, np.full(len(rim), z)]) for s in (0.3, 0.6, 0.9)])
    return pose.apply(np.vstack([sides, top]))


def noisy(points: Array, seed: int = 0) -> Array:
    return points + np.random.default_rng(seed).normal(scale=0.0015, size=points.shape)


@settings(max_examples=60, deadline=None)
@given(THINGS, st.floats(0.0, 1.0), TURNS, TURNS, st.integers(0, 99))
def test_what_slipped_within_its_own_outline_is_found_where_it_stands(
    thing: DetectedObject, share: float, way: float, yaw: float, seed: int
) -> None:
    spot = spot_of(thing, yaw=yaw)
    off = share * (min(thing.size[:2]) / 2 + THIN / 2)
    truth = spot @ Transform((off * math.cos(way), off * math.sin(way), 0.0))
    found = beside(noisy(face(thing, truth), seed), spot, thing, TABLE)
    assert found is not None
    assert np.linalg.norm(found.position - truth.position) < 0.015
    assert found.rotation == pytest.approx(spot.rotation)


@settings(max_examples=60, deadline=None)
@given(THINGS, THINGS, st.floats(0.0, 0.1), TURNS)
def test_what_stood_beside_the_spot_all_along_is_never_taken_for_it(
    thing: DetectedObject, other: DetectedObject, gap: float, way: float
) -> None:
    spot = spot_of(thing)
    apart = max(thing.size[:2]) / 2 + max(other.size[:2]) / 2 + gap
    x, y = spot.position[:2] + apart * np.array([math.cos(way), math.sin(way)])
    assert beside(noisy(face(other, spot_of(other, x, y))), spot, thing, TABLE) is None


@settings(max_examples=40, deadline=None)
@given(st.sampled_from([0.5, 0.8, 1.2, 1.6]), st.floats(0.0, 0.03))
def test_a_thing_of_another_height_is_not_it(share: float, off: float) -> None:
    spot = spot_of(CAN)
    size = (0.07, 0.07, share * CAN.size[2])
    other = DetectedObject("can", CAN.pose, size, "cylinder", 1, TABLE)
    assert beside(face(other, spot_of(other, 0.8 + off, 0.1)), spot, CAN, TABLE) is None


def test_what_lies_there_does_not_stand() -> None:
    spot = spot_of(CAN)
    upright = face(CAN, Transform(), eye=(-1.0, 0.0))
    lying = Transform((0.81, 0.1, TABLE + 0.035)).apply(upright[:, [2, 1, 0]])
    assert beside(lying, spot, CAN, TABLE) is None
    assert standing(lying, spot, CAN, TABLE) == "toppled"


def test_a_top_of_which_the_hand_hides_most_is_enough() -> None:
    spot = spot_of(CAN)
    whole = face(CAN, spot @ Transform((0.03, 0.0, 0.0)))
    rise = whole[:, 2] - TABLE
    below = whole[rise < 0.09]
    rim = whole[rise > 0.129][:10]
    seen = np.vstack([below, rim])
    assert beside(seen, spot, CAN, TABLE) is not None
    assert beside(below, spot, CAN, TABLE) is None
    assert beside(rim, spot, CAN, TABLE) is None


def test_nothing_there_is_nothing() -> None:
    assert beside(np.empty((0, 3)), spot_of(CAN), CAN, TABLE) is None


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 999))
def test_new_is_what_lies_apart_from_all_that_was_seen(seed: int) -> None:
    random = np.random.default_rng(seed)
    points, before = random.uniform(0, 0.3, (80, 3)), random.uniform(0, 0.3, (20, 3))
    new = unseen_before(points, before)
    apart = np.linalg.norm(points[:, None] - before[None], axis=2).min(axis=1)
    assert np.array_equal(new, points[apart > KNOWN])
    assert np.array_equal(unseen_before(points, np.empty((0, 3))), points)
    assert len(unseen_before(np.empty((0, 3)), before)) == 0


def test_a_neighbour_that_was_there_before_does_not_hide_what_came() -> None:
    spot = spot_of(CAN)
    neighbour = face(CARTON, spot_of(CARTON, 0.8, 0.23))
    came = face(CAN, spot @ Transform((-0.03, 0.0, 0.0)))
    new = unseen_before(np.vstack([neighbour, came]), neighbour)
    assert beside(new, spot, CAN, TABLE) is not None
    assert beside(unseen_before(neighbour, neighbour), spot, CAN, TABLE) is None
    assert INSIDE < KNOWN


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from([(0.12, 0.05), (0.14, 0.06), (0.16, 0.065), (0.18, 0.07)]),
    st.floats(0.0, 0.9),
    TURNS,
    st.integers(0, 99),
)
def test_a_bowl_is_found_by_its_rim(
    measures: tuple[float, float], share: float, way: float, seed: int
) -> None:
    across, height = measures
    size = (across, across, height)
    bowl = DetectedObject("bowl", CAN.pose, size, "cylinder", 1, TABLE)
    spot = spot_of(bowl)
    off = share * across / 2
    truth = spot @ Transform((off * math.cos(way), off * math.sin(way), 0.0))
    points = noisy(inside_and_out(bowl, truth), seed)
    found = beside(points, spot, bowl, TABLE, hollow=True)
    assert found is not None
    assert np.linalg.norm(found.position - truth.position) < 0.01
    assert beside(points[rim_side(points, truth)], spot, bowl, TABLE, hollow=True) is None


def test_a_bowl_that_leans_on_something_does_not_stand() -> None:
    size = (0.18, 0.18, 0.07)
    bowl = DetectedObject("bowl", CAN.pose, size, "cylinder", 1, TABLE)
    spot = spot_of(bowl)
    tilt = Transform((0.0, 0.0, 0.03), (math.cos(0.2), 0.0, math.sin(0.2), 0.0))
    points = inside_and_out(bowl, spot @ tilt)
    assert beside(points, spot, bowl, TABLE, hollow=True) is None


def inside_and_out(bowl: DetectedObject, pose: Transform) -> Array:
    """Points of a bowl that a camera above sees: its inside, and the near half of its outside."""
    turn = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    rows = []
    for level in np.linspace(0.0, 1.0, 12):
        radius = (0.45 + 0.55 * level) * bowl.size[0] / 2
        rise = np.full((len(turn), 1), (level - 0.5) * bowl.size[2])
        rows.append(np.hstack([(radius - 0.004) * circle, rise]))
        rows.append(np.hstack([radius * circle, rise])[circle[:, 0] < 0.0])
    return pose.apply(np.vstack(rows))


def rim_side(points: Array, pose: Transform) -> NDArray[np.bool_]:
    """Which points lie on one third of a bowl: what a hand leaves of it that is in the way."""
    local = pose.inverse().apply(points)
    return np.asarray(np.abs(np.arctan2(local[:, 1], local[:, 0])) < np.pi / 3)
