"""Turn, size and place by a thing's own points, where what the network said is a little wrong."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_skills.perception.learned.refining import Seen, refined
from momantu_skills.perception.learned.solids import Solid

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.world import seeded

EYE = 0.8
"""Height of the camera above the surface, m; it is at x = y = 0."""
NOTHING = np.zeros((0, 3))


def cylinder(pose: Transform, radius: float, height: float) -> tuple[Array, Array]:
    """Points and normals (n, 3) of the side that the camera sees, in `level`."""
    draw = seeded("cylinder")
    bearing = draw.uniform(-math.pi, math.pi, 3000)
    out = np.column_stack([np.cos(bearing), np.sin(bearing), np.zeros(len(bearing))])
    own = out * radius
    own[:, 2] = draw.uniform(-height / 2, height / 2, len(own))
    points, normals = pose.apply(own), out @ pose.rotation.T
    shown = ((np.array([0.0, 0.0, EYE]) - points) * normals).sum(axis=1) > 0.0
    return points[shown], normals[shown]


def seen(points: Array, normals: Array, around: Array = NOTHING) -> Seen:
    return Seen(points, normals, np.zeros(len(points), dtype=bool), around, EYE)


def said(category: str, pose: Transform, size: tuple[float, float, float]) -> Solid:
    return Solid(category, pose, size, 300, 0.9, False)


@pytest.mark.parametrize("category", ["can", "bottle"])
@pytest.mark.parametrize("share", [0.85, 1.2])
def test_a_round_thing_gets_the_size_and_place_of_its_side(category: str, share: float) -> None:
    true = Transform((0.1, 1.0, 0.06))
    points, normals = cylinder(true, 0.033, 0.12)
    wrong = said(category, Transform((0.105, 1.008, 0.058)), (0.066 * share, 0.066 * share, 0.11))
    found = refined(wrong, seen(points, normals))
    assert found.size == pytest.approx((0.066, 0.066, 0.12), abs=0.004)
    assert np.allclose(found.frame_from_object.position, true.position, atol=0.003)


def test_the_top_of_a_can_that_is_seen_from_above_is_not_its_side() -> None:
    true = Transform((0.1, 0.3, 0.045))
    points, normals = cylinder(true, 0.042, 0.09)
    draw = seeded("top")
    away, bearing = 0.042 * np.sqrt(draw.uniform(size=600)), draw.uniform(-math.pi, math.pi, 600)
    top = np.column_stack([away * np.cos(bearing), away * np.sin(bearing), np.full(600, 0.045)])
    both = np.concatenate([points[:60], true.apply(top)])
    up = np.concatenate([normals[:60], np.tile((0.0, 0.0, 1.0), (600, 1))])
    found = refined(said("can", true, (0.084, 0.084, 0.09)), seen(both, up))
    assert found.size[:2] == pytest.approx((0.084, 0.084), abs=0.004)


def test_a_thing_that_stands_begins_at_the_surface_though_its_foot_is_hidden() -> None:
    true = Transform((0.1, 1.0, 0.06))
    points, normals = cylinder(true, 0.033, 0.12)
    upper = points[:, 2] > 0.04
    found = refined(said("can", true, (0.066, 0.066, 0.12)), seen(points[upper], normals[upper]))
    assert found.size[2] == pytest.approx(0.12, abs=0.004)


def test_a_thing_on_another_keeps_its_lower_end() -> None:
    true = Transform((0.1, 1.0, 0.16))
    points, normals = cylinder(true, 0.033, 0.12)
    found = refined(said("can", true, (0.066, 0.066, 0.12)), seen(points, normals))
    assert found.size[2] == pytest.approx(0.12, abs=0.006)
    assert found.frame_from_object.position[2] == pytest.approx(0.16, abs=0.003)


@pytest.mark.parametrize("share", [0.6, 0.85, 1.3])
def test_a_lying_can_is_as_wide_as_it_is_high(share: float) -> None:
    """Its front is hidden, so that its side alone does not tell how wide it is."""
    level = quaternion_from_axis_angle((0.0, 1.0, 0.0), math.pi / 2)
    true = Transform((0.1, 1.0, 0.033), level)
    points, normals = cylinder(true, 0.033, 0.16)
    upper = points[:, 2] > 0.05
    wrong = said("can", Transform((0.1, 1.0, 0.028), level), (0.066 * share, 0.066 * share, 0.15))
    found = refined(wrong, seen(points[upper], normals[upper]))
    assert found.size[:2] == pytest.approx((0.066, 0.066), abs=0.004)
    assert found.size[2] == pytest.approx(0.16, abs=0.01)
    assert np.allclose(found.frame_from_object.position, true.position, atol=0.004)


def test_what_is_too_high_to_lie_on_the_surface_keeps_its_width() -> None:
    level = quaternion_from_axis_angle((0.0, 1.0, 0.0), math.pi / 2)
    true = Transform((0.1, 1.0, 0.133), level)  # on another thing
    points, normals = cylinder(true, 0.033, 0.16)
    found = refined(said("can", true, (0.066, 0.066, 0.16)), seen(points, normals))
    assert found.size[:2] == pytest.approx((0.066, 0.066), abs=0.004)
    assert found.size[2] == pytest.approx(0.16, abs=0.01)


BOX = np.array([0.08, 0.12, 0.10])


def box(pose: Transform) -> tuple[Array, Array]:
    """Points and normals (n, 3) of three faces of a box, two of them upright, in `level`."""
    draw = seeded("box")
    own = draw.uniform(-0.5, 0.5, (3000, 3)) * BOX
    side = draw.integers(3, size=len(own))
    normals = np.zeros_like(own)
    for axis, sign in enumerate((-1.0, -1.0, 1.0)):
        own[side == axis, axis] = sign * BOX[axis] / 2
        normals[side == axis, axis] = sign
    return pose.apply(own), normals @ pose.rotation.T


@pytest.mark.parametrize("known", [True, False], ids=["by normals", "by points"])
@pytest.mark.parametrize("off", [0.1, -0.6])
def test_a_box_gets_the_turn_and_size_of_its_sides(known: bool, off: float) -> None:
    true = Transform((0.1, 1.0, 0.05), quaternion_from_axis_angle((0.0, 0.0, 1.0), 0.3))
    points, normals = box(true)
    turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), 0.3 + off)
    wrong = said("box", Transform((0.105, 0.995, 0.05), turn), (0.095, 0.11, 0.09))
    found = refined(wrong, seen(points, normals * known))
    assert found.size == pytest.approx((0.08, 0.12, 0.10), abs=0.003)
    assert found.frame_from_object.yaw == pytest.approx(0.3, abs=0.02)


def test_a_hidden_end_of_a_box_is_where_the_network_says() -> None:
    true = Transform((0.1, 1.0, 0.05), quaternion_from_axis_angle((0.0, 0.0, 1.0), 0.3))
    points, normals = box(true)
    front = true.inverse().apply(points)[:, 1] < -0.01  # 5 cm of 12 are seen
    turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), 0.4)
    wrong = said("box", Transform((0.1, 1.0, 0.05), turn), (0.08, 0.12, 0.10))
    found = refined(wrong, seen(points[front], normals[front]))
    assert found.size == pytest.approx((0.08, 0.12, 0.10), abs=0.003)
    assert found.frame_from_object.yaw == pytest.approx(0.3, abs=0.02)
    assert np.allclose(found.frame_from_object.position, true.position, atol=0.005)


def test_points_of_its_neighbour_do_not_make_a_box_larger() -> None:
    true = Transform((0.1, 1.0, 0.05), quaternion_from_axis_angle((0.0, 0.0, 1.0), 0.3))
    points, normals = box(true)
    beside, others = box(true @ Transform((0.0, 0.14, 0.0)))
    both = np.concatenate([points, beside[::8]]), np.concatenate([normals, others[::8]])
    found = refined(said("box", true, (0.08, 0.12, 0.10)), seen(*both))
    assert found.size == pytest.approx((0.08, 0.12, 0.10), abs=0.02)


@pytest.mark.parametrize("named", [True, False], ids=["by the network", "by what is beside it"])
@pytest.mark.parametrize("yaw", [-2.0, -0.5])
def test_a_mug_is_turned_towards_its_handle(named: bool, yaw: float) -> None:
    true = Transform((0.1, 1.0, 0.05), quaternion_from_axis_angle((0.0, 0.0, 1.0), yaw))
    points, normals = cylinder(true, 0.04, 0.10)
    bar = np.column_stack([np.linspace(0.05, 0.07, 20), np.zeros(20), np.linspace(-0.02, 0.02, 20)])
    handle = true.apply(bar)
    start = said("mug", Transform(true.position), (0.08, 0.08, 0.10))
    if named:
        both = np.concatenate([points, handle])
        of_handle = np.arange(len(both)) >= len(points)
        normals = np.concatenate([normals, np.zeros((20, 3))])
        found = refined(start, Seen(both, normals, of_handle, NOTHING, EYE))
    else:
        found = refined(start, seen(points, normals, handle))
    assert found.handle
    assert found.frame_from_object.yaw == pytest.approx(yaw, abs=0.05)
    assert found.size == pytest.approx((0.08, 0.08, 0.10), abs=0.003)


def test_a_mug_without_a_handle_in_view_says_so() -> None:
    true = Transform((0.1, 1.0, 0.05))
    start = said("mug", true, (0.08, 0.08, 0.10))
    assert not refined(start, seen(*cylinder(true, 0.04, 0.10))).handle


def test_few_points_change_nothing() -> None:
    true = Transform((0.1, 1.0, 0.05))
    points, normals = cylinder(true, 0.04, 0.10)
    start = said("can", true, (0.07, 0.07, 0.09))
    assert refined(start, seen(points[:10], normals[:10])) is start


def test_points_of_another_shape_do_not_move_a_thing_far() -> None:
    true = Transform((0.1, 1.0, 0.06))
    points, normals = cylinder(true, 0.10, 0.12)
    start = said("can", true, (0.066, 0.066, 0.12))
    found = refined(start, seen(points, normals))
    assert found.size[:2] == start.size[:2]
