"""From a network's answers to things: separated, fitted, symmetric as they are."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_skills.perception.learned.fusing import Look, fused
from momantu_skills.perception.learned.instances import instances
from momantu_skills.perception.learned.network import classes_of
from momantu_skills.perception.learned.similarity import fit, similarities
from momantu_skills.perception.learned.solids import Solid, solid
from momantu_skills.perception.learned.targets import VALID, Truth, targets

from momantu_bt.categories import USUAL
from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.world import seeded

EYE = 0.9
"""Height of the camera above the surface, m."""
CLASSES = classes_of(USUAL)


def turn(axis: tuple[float, float, float], degrees: float) -> Array:
    return Transform(quaternion=quaternion_from_axis_angle(axis, math.radians(degrees))).rotation


def around(pose: Transform, size: Array, count: int = 900) -> Array:
    """Points (count, 3) on the side of an upright round thing that faces the camera."""
    draw = seeded("around", count)
    bearing = draw.uniform(math.pi, 2 * math.pi, count)  # the camera is at y = 0, things beyond
    own = np.column_stack(
        [
            size[0] / 2 * np.cos(bearing),
            size[1] / 2 * np.sin(bearing),
            draw.uniform(-0.5, 0.5, count) * size[2],
        ]
    )
    return pose.apply(own)


def said(points: Array, truth: Truth) -> tuple[Array, Array, Array]:
    """Perfect coordinates, offsets in m, and chances, of points (n, 3) of one thing."""
    grid = points.reshape(-1, 1, 3).astype(np.float32)
    made = targets(
        grid, np.full(grid.shape[:2], truth.number, dtype=np.uint8), EYE, [truth], CLASSES
    )
    coordinates = made.coordinates[0, :, :, 0].T.astype(np.float64)
    chances = np.zeros((len(points), len(USUAL)))
    chances[:, list(USUAL).index(truth.category)] = 1.0
    return coordinates, made.offsets[:, :, 0].T * 0.1, chances


@pytest.mark.parametrize("seed", range(6))
def test_a_similarity_is_found_among_wrong_points(seed: int) -> None:
    draw = seeded("similarity", seed)
    source = draw.uniform(-0.5, 0.5, (300, 3))
    rotation, scale, shift = turn((1, 2, 3), 70 * seed), 0.2, np.array([0.3, 1.0, 0.1])
    target = scale * source @ rotation.T + shift
    target[:120] += draw.uniform(-0.2, 0.2, (120, 3))
    found = fit(source, target, 0.005, (0.05, 0.5), draw)
    assert found is not None
    assert found.scale == pytest.approx(scale, rel=0.02)
    assert np.allclose(found.rotation, rotation, atol=0.03)
    assert np.linalg.norm(found.shift - shift) < 0.005
    assert found.fitting[120:].all()


def test_a_mirror_image_is_no_similarity() -> None:
    source = seeded("mirror").uniform(-1, 1, (1, 50, 3))
    rotations, _, _ = similarities(source, source * (-1, 1, 1))
    assert np.linalg.det(rotations[0]) == pytest.approx(1.0)


def test_nothing_fits_points_without_order() -> None:
    draw = seeded("noise")
    assert fit(draw.random((3, 3)), draw.random((3, 3)), 0.01, (0.1, 0.5), draw) is None
    assert fit(draw.random((50, 3)), draw.random((50, 3)), 1e-6, (0.1, 0.5), draw) is None


@pytest.mark.parametrize("apart", [0.05, 0.07, 0.12])
def test_votes_for_two_middles_are_two_things(apart: float) -> None:
    draw = seeded("votes")
    votes = np.concatenate(
        [draw.normal((x, 1.0, 0.05), 0.006, (200, 3)) for x in (0.0, apart, 3.0)]
    )
    owner = instances(votes)
    assert set(owner.tolist()) - {-1} == {0, 1, 2}
    for first in (0, 200, 400):
        mine = owner[first : first + 200]
        assert (mine == np.bincount(mine[mine >= 0]).argmax()).mean() > 0.95


def test_few_votes_are_no_thing() -> None:
    assert (instances(seeded("few").normal(0, 0.003, (8, 3))) == -1).all()
    assert len(instances(np.zeros((0, 3)))) == 0


@pytest.mark.parametrize("name", ["bottle", "bowl", "can"])
@pytest.mark.parametrize("yaw", [0.0, 100.0, 200.0])
def test_perfect_answers_give_the_exact_round_thing(name: str, yaw: float) -> None:
    pose = Transform((0.1, 1.0, 0.06), quaternion_from_axis_angle((0, 0, 1), math.radians(yaw)))
    size = np.array([0.07, 0.07, 0.12])
    truth = Truth(1, name, USUAL[name], pose, size)
    points = around(pose, size)
    coordinates, offsets, chances = said(points, truth)
    assert np.allclose(points + offsets, pose.position, atol=1e-5)
    found = solid(points, coordinates[None], chances, np.zeros(len(points), bool), seeded("a"))
    assert found is not None
    assert found.category == name
    assert np.allclose(found.frame_from_object.position, pose.position, atol=1e-3)
    assert np.allclose(found.size, size, rtol=0.03)
    assert abs(found.frame_from_object.rotation[2, 2]) == pytest.approx(1.0, abs=1e-6)


def test_round_things_say_the_same_however_they_are_turned() -> None:
    size = np.array([0.07, 0.07, 0.2])
    points = around(Transform((0.1, 1.0, 0.1)), size)
    spoken = []
    for yaw in (0.0, 1.0, 4.0):
        pose = Transform((0.1, 1.0, 0.1), quaternion_from_axis_angle((0, 0, 1), yaw))
        spoken.append(said(points, Truth(1, "bottle", USUAL["bottle"], pose, size))[0])
    assert np.allclose(spoken[0], spoken[1], atol=1e-5)
    assert np.allclose(spoken[0], spoken[2], atol=1e-5)


def test_a_box_has_four_equally_good_answers() -> None:
    pose = Transform((0.0, 1.0, 0.1), quaternion_from_axis_angle((1, 0, 0), math.pi / 2))
    grid = seeded("box").uniform(-0.04, 0.04, (5, 5, 3)) + np.array([0.0, 1.0, 0.1])
    truth = Truth(1, "box", USUAL["box"], pose, np.array([0.05, 0.08, 0.15]))
    made = targets(grid.astype(np.float32), np.ones((5, 5), dtype=np.uint8), EYE, [truth], CLASSES)
    assert made.coordinates.shape[0] == VALID == 4
    heights = made.coordinates[:, 2]
    assert np.allclose(heights, heights[0])  # all have the upright axis as z
    assert not np.allclose(made.coordinates[0], made.coordinates[1])


def test_a_mugs_handle_tells_how_it_is_turned() -> None:
    size = np.array([0.08, 0.08, 0.1])
    body = around(Transform((0.0, 1.0, 0.05)), size, 400)
    for yaw in (-2.0, -1.0):
        pose = Transform((0.0, 1.0, 0.05), quaternion_from_axis_angle((0, 0, 1), yaw))
        bar = pose.apply(
            np.column_stack([np.linspace(0.045, 0.07, 40), np.zeros(40), np.zeros(40)])
        )
        points = np.concatenate([body, bar])
        coordinates, _, chances = said(points, Truth(1, "mug", USUAL["mug"], pose, size))
        of_handle = np.arange(len(points)) >= 400
        found = solid(points, coordinates[None], chances, of_handle, seeded("mug"))
        assert found is not None
        assert found.handle
        assert found.frame_from_object.yaw == pytest.approx(yaw, abs=0.02)
        assert found.size == pytest.approx(size.tolist(), rel=0.05)


@pytest.mark.parametrize(
    ("name", "tilt", "cosine"),
    [("can", 70, 0.0), ("mug", 70, 0.0), ("bottle", 70, 0.342), ("can", 10, 1.0), ("box", 20, 1.0)],
)
def test_what_rests_on_a_level_surface_is_upright_or_level(
    name: str, tilt: float, cosine: float
) -> None:
    """cosine: of the angle between its axis and the vertical; a bottle may lie on its shoulder."""
    pose = Transform((0.0, 1.0, 0.1), quaternion_from_axis_angle((1, 0, 0), math.radians(tilt)))
    own = seeded("tilted").uniform(-0.5, 0.5, (300, 3)) * (0.07, 0.07, 0.16)
    of_name = np.zeros((300, len(USUAL)))
    of_name[:, list(USUAL).index(name)] = 1.0
    normalized = own / np.linalg.norm((0.07, 0.07, 0.16))
    found = solid(
        pose.apply(own), normalized[None], of_name, np.zeros(300, dtype=bool), seeded("tilt")
    )
    assert found is not None
    assert abs(found.frame_from_object.rotation[2, 2]) == pytest.approx(cosine, abs=0.02)


def thing(x: float, cells: int, category: str = "can", wide: float = 0.07) -> Solid:
    return Solid(category, Transform((x, 0, 0.06)), (wide, wide, 0.12), cells, 0.9, False)


def test_views_of_one_thing_are_one_thing() -> None:
    looks = [
        Look(0.70, 0.4, 1.0, (thing(0.0, 300), thing(0.3, 50))),
        Look(0.70, 0.4, 2.0, (thing(0.01, 100),)),
    ]
    found = fused(looks)
    assert [one.cells for one in found] == [400, 50]
    assert found[0].frame_from_object.position[0] == pytest.approx(0.0025)


def test_the_likelier_category_wins() -> None:
    looks = [
        Look(0.7, 0.4, 1.0, (thing(0.0, 300),)),
        Look(0.7, 0.4, 2.0, (thing(0.01, 100, "mug"),)),
    ]
    assert [one.category for one in fused(looks)] == ["can"]


@pytest.mark.parametrize(("cells", "turned"), [(180, True), (60, False)])
def test_a_fragment_with_a_handle_is_no_better_than_a_whole_mug(cells: int, turned: bool) -> None:
    """cells: of the view that shows the handle; turned: whether it tells how the mug is turned."""
    yaw = Transform((0.01, 0.0, 0.06), quaternion_from_axis_angle((0, 0, 1), 1.0))
    handle = Solid("mug", yaw, (0.05, 0.05, 0.08), cells, 0.9, True)
    looks = [Look(0.7, 0.4, 1.0, (thing(0.0, 300, "mug"),)), Look(0.7, 0.4, 2.0, (handle,))]
    (found,) = fused(looks)
    assert found.handle is turned
    assert found.size == (handle.size if turned else thing(0.0, 300).size)


def test_views_that_differ_in_height_are_shifted_together() -> None:
    looks = [Look(0.70, 1.0, 1.0, (thing(0.0, 10),)), Look(0.72, 1.0, 2.0, (thing(0.5, 10),))]
    heights = sorted(one.frame_from_object.position[2] for one in fused(looks))
    assert heights == pytest.approx([0.05, 0.07])
