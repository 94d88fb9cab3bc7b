"""Drawn things: what is seen is what is touched, in sizes and weights that people expect."""

import numpy as np
import pytest
import trimesh
from momantu_worlds.sapien.build.meshes import volume
from momantu_worlds.scenes.catalogue.objects import OBJECT_KINDS, Thing
from momantu_worlds.scenes.catalogue.random_objects import GRASPABLE, HOLLOW, draw_look, draw_thing
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Hull, Mesh, Part

from momantu_bt.world import seeded

NEAR = 0.0021
"""m; how far what is seen may be from what is touched: 2 mm, and a hair at the edge of a can."""
RAYS = 400


def drawn(kind: str, number: int, *, graspable: bool = False) -> Thing:
    draw, paint = seeded(number, "thing", kind), seeded(number, "paint", kind)
    return draw_thing(kind, draw, paint, graspable=graspable)


def solid(part: Part) -> trimesh.Trimesh:
    shape = part.geometry
    if isinstance(shape, Box):
        made = trimesh.creation.box(shape.size)
    elif isinstance(shape, Cylinder):
        made = trimesh.creation.cylinder(shape.radius, shape.height, sections=128)
    elif isinstance(shape, Hull):
        made = trimesh.convex.convex_hull(shape.vertices)
    else:
        assert isinstance(shape, Mesh)
        made = trimesh.Trimesh(shape.vertices, shape.triangles, process=False)
    return made.apply_transform(part.body_from_part.matrix)


def surface(thing: Thing, *, touched: bool) -> trimesh.Trimesh:
    parts = [p for p in thing.parts() if (p.collision if touched else p.visual)]
    return trimesh.util.concatenate([solid(part) for part in parts])


def first_hits(mesh: trimesh.Trimesh, seed: int) -> np.ndarray:
    """Where rays from all around, above and into it meet a thing first: (n, 3)."""
    draw = seeded(seed, "rays")
    low, high = mesh.bounds
    targets = draw.uniform(low, high, (RAYS, 3))
    directions = draw.normal(size=(RAYS, 3))
    directions[: RAYS // 3, 2] = -3.0 * np.abs(directions[: RAYS // 3, 2])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits, _, _ = mesh.ray.intersects_location(targets - directions, directions, multiple_hits=False)
    return hits[hits[:, 2] > 1e-4]


def distances(points: np.ndarray, mesh: trimesh.Trimesh) -> np.ndarray:
    triangles = mesh.triangles
    rows, columns = np.indices((len(points), len(triangles))).reshape(2, -1)
    nearest = trimesh.triangles.closest_point(triangles[columns], points[rows])
    apart = np.linalg.norm(nearest - points[rows], axis=1)
    return apart.reshape(len(points), len(triangles)).min(axis=1)


@pytest.mark.parametrize("number", range(3))
@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_what_is_seen_is_what_is_touched(kind: str, number: int) -> None:
    thing = drawn(kind, number)
    seen, touched = surface(thing, touched=False), surface(thing, touched=True)
    assert distances(first_hits(seen, number), touched).max() <= NEAR
    assert distances(first_hits(touched, number), seen).max() <= NEAR


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_the_same_draw_gives_the_same_thing_and_others_differ(kind: str) -> None:
    assert drawn(kind, 1) == drawn(kind, 1)
    assert len({drawn(kind, n).size for n in range(20)}) == 20
    assert len({drawn(kind, n).look for n in range(20)}) >= 10


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_every_kind_has_several_patterns(kind: str) -> None:
    looks = [drawn(kind, n).look for n in range(60)]
    shapes = {
        (len(look.bands), look.label is None, look.trim == look.color) for look in looks if look
    }
    assert len(shapes) >= 4


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_paint_changes_nothing_that_is_touched(kind: str) -> None:
    bare = Thing(kind, drawn(kind, 4).size, 0.3, (0.5, 0.5, 0.5))
    look = draw_look(kind, (0.1, 0.2, 0.3), seeded(9, "paint"))
    painted = Thing(kind, bare.size, 0.3, (0.1, 0.2, 0.3), look)
    for one, other in zip(
        (p for p in bare.parts() if p.collision),
        (p for p in painted.parts() if p.collision),
        strict=True,
    ):
        assert one.body_from_part == other.body_from_part
        assert type(one.geometry) is type(other.geometry)
        assert volume(one.geometry) == volume(other.geometry)


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_weights_are_those_of_what_it_is_made_of(kind: str) -> None:
    for number in range(10):
        thing = drawn(kind, number)
        bulk = sum(volume(part.geometry) for part in thing.parts() if part.collision)
        density = thing.mass / bulk
        low, high = (1000.0, 3500.0) if kind in HOLLOW else (200.0, 1500.0)
        assert low <= density <= high, (thing.size, thing.mass)


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_graspable_ones_fit_between_fingers_as_far_as_their_kind_allows(kind: str) -> None:
    for number in range(40):
        thing = drawn(kind, number, graspable=True)
        assert min(thing.size[:2]) <= GRASPABLE or kind == "bowl"


def test_sizes_and_colours_that_are_given_are_kept() -> None:
    size, color = (0.07, 0.07, 0.12), (0.9, 0.1, 0.2)
    thing = draw_thing("can", seeded(0), seeded(1), size=size, color=color)
    assert (thing.size, thing.color) == (size, color)
    assert thing.look is not None
    assert thing.look.color == color
