"""Shapes of labelled pictures: in their box, kept apart, at rest where they are put."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_worlds.labelled.families import CATEGORIES, FAMILIES, draw_shape
from momantu_worlds.labelled.heaps import heap, resting
from momantu_worlds.labelled.shape import Shape
from momantu_worlds.labelled.stock import Stock
from momantu_worlds.sapien.build.meshes import collision_mesh
from momantu_worlds.scenes.geometry.bodies import Hull, Mesh
from shapely.geometry import MultiPoint

from momantu_bt.geometry import Array
from momantu_bt.world import seeded

KINDS = [
    (category, testing, number)
    for category in CATEGORIES
    for testing in (False, True)
    for number in range(8)
]


def points(shape: Shape, *, handle: bool = True) -> Array:
    """Vertices (n, 3) of a shape's parts in its own frame."""
    found = []
    for part in shape.parts:
        geometry = part.geometry
        if not handle and part.geometry is shape.parts[-1].geometry and shape.category == "mug":
            continue
        if isinstance(geometry, Mesh | Hull):
            found.append(part.body_from_part.apply(geometry.vertices))
        else:
            found.append(part.body_from_part.apply(collision_mesh(geometry).vertices))
    return np.concatenate(found)


@pytest.mark.parametrize(("category", "testing", "number"), KINDS)
def test_a_shape_fills_its_box(category: str, testing: bool, number: int) -> None:
    shape = draw_shape(category, seeded("shape", number), testing=testing)
    there = points(shape, handle=False)
    half = np.array(shape.size) / 2
    assert np.abs(there).max(axis=0) == pytest.approx(half, rel=0.02, abs=0.001)
    assert 0.02 < half.max() < 0.2


@pytest.mark.parametrize("category", CATEGORIES)
def test_families_for_testing_are_never_trained_on(category: str) -> None:
    training, testing = FAMILIES[category]
    assert training
    assert testing
    assert not set(training.values()) & set(testing.values())
    drawn = {draw_shape(category, seeded(n), testing=False).family for n in range(40)}
    assert drawn == set(training)


def test_a_mugs_handle_reaches_out_to_the_front() -> None:
    for number in range(12):
        shape = draw_shape("mug", seeded("mug", number), testing=number % 2 == 0)
        assert points(shape)[:, 0].max() > shape.size[0] / 2 + 0.012
        assert points(shape)[:, 0].min() > -shape.size[0] / 2 - 0.001


@pytest.mark.parametrize(("category", "testing", "number"), KINDS)
def test_what_rests_touches_the_surface_and_is_not_in_it(
    category: str, testing: bool, number: int
) -> None:
    draw = seeded("rest", number)
    shape = draw_shape(category, draw, testing=testing)
    low = resting(draw, shape).apply(points(shape))[:, 2].min()
    assert low == pytest.approx(0.0, abs=0.002)


def test_things_of_a_heap_stand_beside_each_other_or_on_boxes() -> None:
    touching = 0
    for number in range(15):
        ground = []
        for laid in heap(seeded("heap", number), (0.3, 0.3), Stock(testing=False)):
            if laid.shape is None or "_in_" in laid.name:
                continue
            there = laid.top_from_thing.apply(laid.shape.outline)
            assert there[:, 2].min() > -1e-6
            if there[:, 2].min() < 0.001:
                ground.append(MultiPoint(there[:, :2]).convex_hull)
        for n, one in enumerate(ground):
            for other in ground[:n]:
                assert one.intersection(other).area < 1e-6
                touching += one.distance(other) < 0.002
    assert touching > 10


def test_the_same_seed_makes_the_same_heap() -> None:
    one, other = (heap(seeded("same"), (0.3, 0.3), Stock(testing=True)) for _ in range(2))
    assert [laid.name for laid in one] == [laid.name for laid in other]
    assert [laid.top_from_thing for laid in one] == [laid.top_from_thing for laid in other]
