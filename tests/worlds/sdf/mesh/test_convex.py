"""What is touched of a mesh covers it, and leaves free what is free."""

import numpy as np
import pytest
import trimesh
from momantu_worlds.sdf.mesh.convex import convex_pieces
from momantu_worlds.sdf.mesh.files import Piece


def piece(*meshes):
    mesh = trimesh.util.concatenate(list(meshes))
    return Piece(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def box(size, at=(0, 0, 0)):
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(at)
    return mesh


def inside_any(hulls, points):
    hit = np.zeros(len(points), dtype=bool)
    for hull in hulls:
        mesh = trimesh.convex.convex_hull(hull)
        planes = np.einsum("ij,ij->i", mesh.face_normals, mesh.triangles[:, 0])
        hit |= (np.asarray(points) @ mesh.face_normals.T <= planes + 1e-3).all(axis=1)
    return hit


def room():
    """Walls, floor and roof in one piece of 4 x 3 x 2 m, with an inside that looks inwards."""
    inner = box((3.8, 2.8, 1.8))
    inner.invert()
    return box((4, 3, 2)), inner


@pytest.mark.parametrize("still", [True, False])
def test_what_hangs_together_is_one_hull_each(still):
    balls = [trimesh.creation.icosphere(subdivisions=2, radius=0.2) for _ in range(3)]
    for number, ball in enumerate(balls):
        ball.apply_translation((number, 0, 0))
    hulls, plain = convex_pieces([piece(*balls)], still=still)
    assert (len(hulls), plain) == (3, True)
    assert sorted(round(float(h[:, 0].mean())) for h in hulls) == [0, 1, 2]


@pytest.mark.parametrize(
    "solid",
    [
        box((1, 1, 1)),
        box((0.05, 0.05, 0.7)),
        trimesh.creation.cylinder(radius=0.4, height=1.0),
        trimesh.creation.icosphere(subdivisions=3),
    ],
    ids=["crate", "leg", "drum", "ball"],
)
def test_a_solid_thing_is_its_hull(solid):
    hulls, plain = convex_pieces([piece(solid)], still=True)
    assert (len(hulls), plain) == (1, True)
    assert trimesh.convex.convex_hull(hulls[0]).volume == pytest.approx(solid.volume, rel=0.01)


def test_a_room_has_its_inside_free():
    hulls, plain = convex_pieces([piece(*room())], still=True)
    assert not plain
    assert not inside_any(hulls, [(0, 0, 0), (1.5, 1.0, 0.5), (-1.8, 0, -0.8)]).any()
    assert inside_any(hulls, [(1.999, 0, 0), (0, -1.499, 0), (0, 0, 0.999), (1.901, 0, 0)]).all()


def test_a_door_in_a_wall_is_free():
    outline = [
        (-1.5, -1),
        (-0.5, -1),
        (-0.5, 1),
        (0.5, 1),
        (0.5, -1),
        (1.5, -1),
        (1.5, 1.4),
        (-1.5, 1.4),
    ]
    front = np.array([(x, 0.05, z) for x, z in outline])
    # the eight corners as triangles, front and back, and the sides between
    caps = np.array([(0, 2, 1), (0, 7, 2), (7, 3, 2), (7, 6, 3), (3, 6, 5), (3, 5, 4)])
    n = len(outline)
    sides = [
        t for i in range(n) for j in ((i + 1) % n,) for t in ((i, j, j + n), (i, j + n, i + n))
    ]
    mesh = trimesh.Trimesh(
        np.concatenate([front, front - (0, 0.1, 0)]), [*caps, *(caps[:, ::-1] + n), *sides]
    )
    mesh.fix_normals()
    hulls, plain = convex_pieces(
        [Piece(np.asarray(mesh.vertices), np.asarray(mesh.faces))], still=True
    )
    assert not plain
    assert not inside_any(hulls, [(0, 0, 0), (0.4, 0, -0.9)]).any()
    assert inside_any(hulls, [(-1, 0.049, 0), (1, -0.049, 0.5), (0, 0.049, 1.2)]).all()


def test_walls_without_thickness_and_roof_are_plates():
    corners = [(0, 0), (2, 0), (2, 2), (0, 2)]
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in corners])
    walls = [
        t for i in range(4) for j in ((i + 1) % 4,) for t in ((i, j, j + 4), (i, j + 4, i + 4))
    ]
    hulls, plain = convex_pieces([Piece(points, np.array(walls))], still=True)
    assert (len(hulls), plain) == (4, False)
    assert not inside_any(hulls, [(1, 1, 0.5)]).any()


def test_what_moves_is_hulls_whatever_its_form():
    hulls, plain = convex_pieces([piece(*room())], still=False)
    assert (len(hulls), plain) == (2, True)


def test_a_flat_thing_has_a_thickness():
    flat = Piece(np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)]), np.array([(0, 1, 2)]))
    (hull,), _ = convex_pieces([flat], still=True)
    assert np.ptp(hull[:, 2]) == pytest.approx(0.01)


def test_the_same_mesh_has_the_same_pieces():
    first, second = (convex_pieces([piece(*room())], still=True)[0] for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


def table():
    """A top on four legs, which touch its corners: one part."""
    legs = [box((0.06, 0.06, 0.68), (x, y, 0.34)) for x in (-0.42, 0.42) for y in (-0.72, 0.72)]
    return trimesh.util.concatenate([box((0.9, 1.5, 0.04), (0, 0, 0.7)), *legs])


@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_a_table_is_its_top_and_its_legs(yaw):
    mesh = table()
    mesh.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
    hulls, plain = convex_pieces([piece(mesh)], still=True)
    assert not plain
    assert len(hulls) < 20
    assert max(hull[:, 2].max() for hull in hulls) == pytest.approx(0.72)
    turn = trimesh.transformations.rotation_matrix(yaw, (0, 0, 1))[:3, :3]
    below = np.array([(0, 0, 0.3), (0.3, 0.5, 0.6), (-0.35, 0, 0.1), (0, 0.65, 0.3)]) @ turn.T
    solid = (
        np.array([(0, 0, 0.7), (0.44, 0.74, 0.7), (0.42, 0.72, 0.3), (-0.42, 0.72, 0.05)]) @ turn.T
    )
    assert not inside_any(hulls, below).any()
    assert inside_any(hulls, solid).all()
