"""Loose things, furniture and the tag: what is seen and what is touched agree."""

import math
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.perception.tags.detector import find_all
from momantu_worlds.scenes.catalogue.furniture import CATALOGUE, furniture, usual_size
from momantu_worlds.scenes.catalogue.lathe import lathe, shell_pieces
from momantu_worlds.scenes.catalogue.objects import OBJECT_KINDS, Thing
from momantu_worlds.scenes.catalogue.shelves import BOARDED, board, boarded
from momantu_worlds.scenes.catalogue.tags import (
    known_ids,
    picture_edge,
    shown_by,
    tag_cells,
    tag_picture,
)
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Hull, Mesh, Part

from momantu_bt.messages import CameraImage
from momantu_bt.tags import FAMILIES

COLOR = (0.5, 0.5, 0.5)
SIZES = {
    "can": (0.07, 0.07, 0.13),
    "bottle": (0.07, 0.07, 0.24),
    "box": (0.08, 0.12, 0.15),
    "mug": (0.08, 0.08, 0.095),
    "bowl": (0.14, 0.14, 0.06),
}


def points(part: Part) -> np.ndarray:
    shape = part.geometry
    if isinstance(shape, Box):
        own = np.array(np.meshgrid(*[(-s / 2, s / 2) for s in shape.size])).reshape(3, -1).T
    elif isinstance(shape, Cylinder):
        turns = np.arange(32) * (math.pi / 16)
        ring = np.stack([np.cos(turns), np.sin(turns)], 1) * shape.radius
        own = np.concatenate(
            [np.column_stack([ring, np.full(32, z)]) for z in (-shape.height / 2, shape.height / 2)]
        )
    else:
        assert isinstance(shape, Mesh | Hull)
        own = shape.vertices
    return part.body_from_part.apply(own)


def extent(parts: list[Part]) -> np.ndarray:
    every = np.concatenate([points(part) for part in parts])
    return np.stack([every.min(axis=0), every.max(axis=0)])


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_what_is_seen_and_what_is_touched_have_one_outline(kind):
    thing = Thing(kind, SIZES[kind], 0.3, COLOR)
    seen = extent([p for p in thing.parts() if p.visual])
    touched = extent([p for p in thing.parts() if p.collision])
    # a convex piece's flat side lies 5 % of the radius within the circle
    assert np.allclose(seen, touched, atol=0.05 * SIZES[kind][0])
    assert seen[0, 2] == pytest.approx(0.0, abs=1e-9)
    assert seen[1, 2] == pytest.approx(thing.height, abs=1e-9)


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_nothing_sticks_out_of_its_reach(kind):
    thing = Thing(kind, SIZES[kind], 0.3, COLOR)
    for part in thing.parts():
        away = np.hypot(points(part)[:, 0], points(part)[:, 1]).max()
        assert away <= thing.reach + 0.006  # a mug's bar has corners


@pytest.mark.parametrize("kind", ["mug", "bowl"])
def test_hollow_things_are_hollow(kind):
    thing = Thing(kind, SIZES[kind], 0.3, COLOR)
    inside = np.array([(0.0, 0.0, 0.6 * thing.height)])
    for part in thing.parts():
        if part.collision and isinstance(part.geometry, Hull):
            hull = trimesh.convex.convex_hull(points(part))
            assert not hull.contains(inside).any()


profiles = st.lists(
    st.tuples(st.floats(0.01, 0.1), st.floats(0.001, 0.05)), min_size=1, max_size=5
).map(
    lambda steps: [
        (r, float(np.sum([h for _, h in steps[: i + 1]]))) for i, (r, _) in enumerate(steps)
    ]
)


@given(profiles)
def test_a_lathe_surface_encloses_the_volume_of_its_profile(steps):
    profile = [(0.0, 0.0), (steps[0][0], 0.0), *steps, (0.0, steps[-1][1])]
    mesh = lathe(profile, segments=64)
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=True)
    whole = (
        math.pi
        / 3
        * sum((b[1] - a[1]) * (a[0] ** 2 + a[0] * b[0] + b[0] ** 2) for a, b in pairwise(profile))
    )
    # 64 faces enclose 0.2 % less than the round body; outside is outside, or it were negative
    assert solid.volume == pytest.approx(whole, rel=0.005)


def test_shell_pieces_are_small_enough_for_the_physics():
    pieces = shell_pieces([(0.04, 0), (0.05, 0.1)], [(0.035, 0), (0.045, 0.1)], 10)
    assert len(pieces) == 10
    assert all(len(piece.vertices) <= 64 for piece in pieces)


@pytest.mark.parametrize("kind", CATALOGUE)
def test_furniture_fills_its_size_and_stands_on_the_floor(kind):
    low, high = extent(list(furniture(kind)))
    assert low[2] == pytest.approx(0.0, abs=1e-9)
    assert np.all(high - low <= np.array(usual_size(kind)) + 1e-9)
    assert np.all(high - low >= 0.8 * np.array(usual_size(kind)))


FAMILY_AND_ID = [(f, i) for f in FAMILIES for i in range(0, known_ids(f), 1 + known_ids(f) // 6)]


@pytest.mark.parametrize(("family", "tag_id"), FAMILY_AND_ID)
def test_a_detector_reads_the_tag_upright_and_measures_its_edge(family, tag_id):
    around = ((40, 40), (40, 40), (0, 0))
    picture = np.pad(tag_picture(tag_id, family), around, constant_values=200)
    image = CameraImage(0.0, "camera", picture, np.zeros(picture.shape[:2]), np.eye(3))
    (found,) = find_all([image], [family])
    assert found.key == (family, tag_id)
    # AprilTag's corners begin at the bottom left of an upright tag
    middle, first = found.corners.mean(axis=0), found.corners[0]
    assert first[0] < middle[0]
    assert first[1] > middle[1]
    edge = np.linalg.norm(found.corners[1] - first)
    assert picture_edge(edge, family) == pytest.approx(picture.shape[0] - 80, rel=0.01)


def test_every_tag_is_told_by_its_picture():
    for family, tag_id in FAMILY_AND_ID:
        assert shown_by(tag_picture(tag_id, family)) == (family, tag_id)
    assert shown_by(np.zeros((80, 80, 3), dtype=np.uint8)) is None


def test_a_tag_has_a_black_border_and_a_white_margin():
    cells = tag_cells(1)
    assert cells[0].all()
    assert not cells[1, 1:-1].any()
    assert picture_edge(0.15) == pytest.approx(0.1875)


@pytest.mark.parametrize("tag_id", [-1, 587])
def test_an_unknown_tag_is_refused(tag_id):
    with pytest.raises(ValueError, match="known: 0 to 586"):
        tag_cells(tag_id)


@pytest.mark.parametrize("kind", BOARDED)
def test_boards_lie_where_they_are_wanted_within_their_frame(kind):
    size, tops = (0.5, 1.8, 1.7), (0.4, 0.8, 1.6)
    frame = boarded(kind, size, None, ())
    whole = boarded(kind, size, None, tops)
    assert len(whole) == len(frame) + len(tops)
    heights = [points(board(kind, size, top, None))[:, 2].max() for top in tops]
    assert heights == pytest.approx(tops)
    low, high = extent(list(whole))
    assert np.all(high - low <= np.array(size) + 1e-9)
