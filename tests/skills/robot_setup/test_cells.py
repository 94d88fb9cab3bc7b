"""Meshes that are far from convex, and the links that a simulator would push out of their hulls."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from momantu_skills.robot_setup.find.base import find_base
from momantu_skills.robot_setup.find.matrix import sample_matrix
from momantu_skills.robot_setup.find.proposal import propose
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.cells import cuts_of, swallowed
from momantu_skills.robot_setup.urdf.prepare import Placed, prepare
from momantu_skills.robot_setup.urdf.simulated import hollow, pressing
from momantu_worlds.robots import fetch
from scipy.spatial import ConvexHull


def facets(low: tuple[float, ...], high: tuple[float, ...]) -> str:
    """A box as the facets of a text STL."""
    corners = np.array(list(product(*zip(low, high, strict=True))))
    hull = ConvexHull(corners)
    text = ""
    for triangle in hull.simplices:
        loop = " ".join("vertex {} {} {}".format(*corners[k]) for k in triangle)
        text += f"facet normal 0 0 1 outer loop {loop} endloop endfacet\n"
    return text


@pytest.fixture(scope="module")
def body(tmp_path_factory: pytest.TempPathFactory) -> Body:
    """A C of two plates and a back, 1 m high, and a small block that turns in its mouth."""
    folder = tmp_path_factory.mktemp("mouth")
    c = [
        ((-0.3, -0.2, 0.0), (0.3, 0.2, 0.1)),
        ((-0.3, -0.2, 0.9), (0.3, 0.2, 1.0)),
        ((-0.3, -0.2, 0.0), (-0.2, 0.2, 1.0)),
    ]
    (folder / "c.stl").write_text(f"solid c\n{''.join(facets(*box) for box in c)}endsolid c")
    mesh = '<collision><geometry><mesh filename="c.stl"/></geometry></collision>'
    block = '<collision><geometry><box size="0.05 0.05 0.05"/></geometry></collision>'
    joint = (
        '<joint name="{n}" type="revolute"><parent link="{p}"/><child link="{c}"/>'
        '<origin xyz="{at}"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
    )
    text = (
        f'<robot name="mouth"><link name="c">{mesh}</link><link name="rod"/>'
        f'<link name="block">{block}</link><link name="plate">{block}</link>'
        + joint.format(n="one", p="c", c="rod", at="0 0 0.5")
        + joint.format(n="two", p="rod", c="block", at="0 0 0")
        + '<joint name="fixed" type="fixed"><parent link="rod"/><child link="plate"/>'
        + '<origin xyz="0.02 0 0"/></joint></robot>'
    )
    (folder / "mouth.urdf").write_text(text)
    prepared = prepare(folder / "mouth.urdf", tmp_path_factory.mktemp("cleaned"))
    base = find_base(prepared.skeleton)
    return Body(prepared.skeleton, Placed(prepared.urdf, base.frame))


def test_a_block_in_the_mouth_lies_in_the_hull_and_not_in_the_mesh(body: Body) -> None:
    assert list(swallowed(body, {"home": {}}, ())) == [("home", "block", "c")]
    assert list(swallowed(body, {"home": {}}, [("block", "c")])) == []
    assert ("c", "block") not in sample_matrix(body, 20).ignored


def test_cuts_are_even_and_within_the_mesh(body: Body) -> None:
    cuts = cuts_of(body, "c")
    assert len(cuts["z"]) == 6
    for name, (low, high) in zip("xyz", [(-0.3, 0.3), (-0.2, 0.2), (0, 1)], strict=True):
        places = np.array([low, *cuts[name], high])
        assert np.diff(places) == pytest.approx((high - low) / (len(places) - 1), abs=2e-3)


def test_neighbours_that_overlap_are_ignored_and_parents_need_not_be(body: Body) -> None:
    matrix = sample_matrix(body, 20)
    assert set(matrix.overlapping) == {("c", "plate"), ("block", "plate")}
    assert set(matrix.overlapping) <= set(matrix.ignored)


def test_fetch_gets_what_a_person_found_by_hand() -> None:
    by_hand = fetch()
    found = propose(by_hand.urdf, samples=200)
    known = {frozenset(pair) for pair in by_hand.ignored_collisions}
    assert {frozenset(pair) for pair in found.matrix.ignored} <= known
    assert by_hand.simulation is not None
    assert set(found.cells) <= set(by_hand.simulation.convex_cells)


def test_hulls_press_where_the_links_are_apart_until_the_mesh_is_cut(body: Body) -> None:
    pair = ("c", "block")
    assert pressing(body, [pair], {}, [{}]) == (pair,)
    assert pressing(body, [pair], {"c": cuts_of(body, "c")}, [{}]) == ()
    assert pressing(body, [pair], {"c": {"z": (0.12, 0.88)}}, []) == ()


def test_a_long_mesh_with_a_hollow_is_cut_and_a_full_one_is_not(body: Body, tmp_path: Path) -> None:
    assert list(hollow(body, -0.1)) == ["c"]
    assert list(hollow(body, 0.25)) == []  # it stands on the floor, as a base does
    (tmp_path / "full.stl").write_text(f"solid f\n{facets((0, 0, 0), (0.2, 0.2, 1))}endsolid f")
    mesh = '<collision><geometry><mesh filename="full.stl"/></geometry></collision>'
    (tmp_path / "full.urdf").write_text(
        f'<robot name="full"><link name="base">{mesh}</link></robot>'
    )
    prepared = prepare(tmp_path / "full.urdf", tmp_path)
    assert list(hollow(Body(prepared.skeleton, Placed(prepared.urdf, "base")), -0.1)) == []
