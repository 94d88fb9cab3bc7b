"""Mesh files as furniture, tables and parts of bodies: seen, touched, and wrong."""

import numpy as np
import pytest
import trimesh
from momantu_worlds.sapien.build.meshes import map_triangles
from momantu_worlds.scenes.arrange.mesh_files import HULL_POINTS, hull_points, mesh_parts, mesh_size
from momantu_worlds.scenes.file.furniture import MeshUse
from momantu_worlds.scenes.file.reader import WorldFileError
from momantu_worlds.scenes.geometry.bodies import Body, Box, Hull, Mesh, Part
from momantu_worlds.scenes.geometry.solids import PlacedBody, outline
from momantu_worlds.scenes.loading import draw_episode, load_world
from momantu_worlds.scenes.site.floor_plan import OCCUPIED, cells_of, draw_plans
from PIL import Image

from momantu_bt.geometry import Transform
from momantu_bt.world import WorldError

RED = [200, 40, 30, 255]


@pytest.fixture
def two_boxes(tmp_path):
    """A glb of two coloured boxes: 1 x 2 x 0.5 m on the floor, and a post on it."""
    low = trimesh.creation.box((1, 2, 0.5))
    low.apply_translation((3, 0, 0.25))
    low.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=RED)
    )
    post = trimesh.creation.box((0.1, 0.1, 1))
    post.apply_translation((3, 0, 1))
    path = tmp_path / "two.glb"
    trimesh.Scene([low, post]).export(path)
    return path


def parts(path, standing=False, **use):
    told = MeshUse(file=str(path), **use)
    return mesh_parts(told, path, standing=standing, color=None)


def box_of(found):
    points = np.concatenate([p.body_from_part.apply(outline(p)) for p in found if p.collision])
    return points.min(axis=0), points.max(axis=0)


def test_pieces_are_seen_in_their_own_colours(two_boxes):
    seen = [p for p in parts(two_boxes) if p.visual]
    assert len(seen) == 2
    assert not any(p.collision for p in seen)
    assert any(p.color == pytest.approx([c / 255 for c in RED[:3]], abs=0.01) for p in seen)
    assert sum(len(p.geometry.triangles) for p in seen) == 24


@pytest.mark.parametrize(
    ("how", "kinds"), [("hull", [Hull]), ("parts", [Hull, Hull]), ("box", [Box]), ("none", [])]
)
def test_what_touches_is_as_told(two_boxes, how, kinds):
    touching = [p for p in parts(two_boxes, collision=how) if p.collision]
    assert [type(p.geometry) for p in touching] == kinds
    assert not any(p.visual for p in touching)
    if kinds:
        low, high = box_of(touching)
        assert low == pytest.approx([2.5, -1, 0], abs=1e-6)
        assert high == pytest.approx([3.5, 1, 1.5], abs=1e-6)


def test_furniture_stands_on_the_floor_above_its_own_place(two_boxes):
    low, high = box_of(parts(two_boxes, standing=True))
    assert low == pytest.approx([-0.5, -1, 0], abs=1e-6)
    assert high == pytest.approx([0.5, 1, 1.5], abs=1e-6)


def test_a_size_stretches_and_a_scale_grows(two_boxes):
    low, high = box_of(parts(two_boxes, standing=True, size=(2, 1, 3)))
    assert high - low == pytest.approx([2, 1, 3], abs=1e-6)
    low, high = box_of(parts(two_boxes, scale=0.1))
    assert high - low == pytest.approx([0.1, 0.2, 0.15], abs=1e-6)
    assert mesh_size(MeshUse(file="two.glb", scale=2), two_boxes) == pytest.approx((2, 4, 3))


def test_what_points_up_along_y_is_turned(two_boxes):
    low, high = box_of(parts(two_boxes, up="y"))
    assert low == pytest.approx([2.5, -1.5, -1], abs=1e-6)
    assert high == pytest.approx([3.5, 0, 1], abs=1e-6)


@pytest.mark.parametrize("ending", ["stl", "obj", "ply", "glb"])
def test_all_formats_give_the_same_shape(tmp_path, ending):
    path = tmp_path / f"box.{ending}"
    trimesh.creation.box((1, 2, 3)).export(path)
    low, high = box_of(parts(path))
    assert high - low == pytest.approx([1, 2, 3], abs=1e-5)


def test_a_picture_on_a_mesh_is_kept(tmp_path):
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    picture = Image.fromarray(np.full((4, 4, 3), (10, 200, 30), dtype=np.uint8))
    flat.visual = trimesh.visual.TextureVisuals(
        uv=[[0, 0], [1, 0], [0, 1]],
        material=trimesh.visual.material.PBRMaterial(baseColorTexture=picture),
    )
    flat.export(tmp_path / "flat.glb")
    seen = parts(tmp_path / "flat.glb", collision="none")
    assert isinstance(seen[0].geometry, Mesh)
    assert tuple(seen[0].geometry.texture[0, 0]) == (10, 200, 30)
    assert seen[0].geometry.uv.shape == (3, 2)


def test_a_flat_mesh_still_has_a_volume_to_touch(tmp_path):
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    flat.export(tmp_path / "flat.stl")
    low, high = box_of(parts(tmp_path / "flat.stl"))
    assert high[2] - low[2] > 0


def test_a_hull_has_few_points_and_nearly_the_shape():
    ball = trimesh.creation.icosphere(subdivisions=4).vertices
    few = hull_points(ball)
    assert len(few) <= HULL_POINTS
    assert trimesh.convex.convex_hull(few).volume > 0.85 * 4 / 3 * np.pi


def test_what_lies_in_a_large_hull_is_told_by_its_faces():
    wedge = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]], dtype=float)
    body = Body("wedge", "body", Transform((1, 0, 0)), (Part(Hull(wedge), visual=False),))
    points = np.array([(1.3, 0.3, 0.3), (2.5, 1.5, 1.5), (1.6, 0.6, 0.6), (1.7, 0.7, 0.7)])
    inside = PlacedBody(body, body.map_from_body).inside(points)
    assert inside.tolist() == [True, False, True, False]


def test_mesh_furniture_is_on_the_map_and_the_laser_meets_it(write, two_boxes):
    path = write(
        furniture={"thing": {"mesh": two_boxes.name, "at": [4, 3, "90 deg"], "shift": "5 cm"}},
        bodies={"part": {"parts": [{"mesh": {"file": two_boxes.name, "collision": "parts"}}]}},
        start={"at": [-2, -2, 0]},
    )
    world = load_world(path)
    assert world.mesh_files() == (two_boxes,)
    plan, _ = draw_plans(world, (0.3, 0.3), 1.4)
    for x, y in ((4, 3), (4.9, 3), (3, 0.9)):
        assert plan.levels[cells_of(plan, x, y)] == OCCUPIED
    bodies = [b for b in draw_episode(path, 1).bodies if b.name in ("thing", "part")]
    triangles = map_triangles(bodies).reshape(-1, 3)
    assert triangles[:, 2].max() == pytest.approx(1.5, abs=1e-6)


def test_a_table_may_be_a_mesh_of_a_told_size(write, two_boxes):
    table = {"mesh": two_boxes.name, "at": [3, 3, 0], "size": [0.8, 1.2, 0.7], "sides": [0]}
    path = write(tables={"own": table}, objects={"cup": {"kind": "mug", "on": "own", "at": [0, 0]}})
    episode = draw_episode(path, 0)
    own = episode.body("own")
    assert own.top.size == pytest.approx((0.8, 1.2))
    low, high = box_of(own.parts)
    assert high - low == pytest.approx([0.8, 1.2, 0.7], abs=1e-6)
    assert float(episode.body("cup").map_from_body.position[2]) == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("bad.glb", b"not a mesh", "cannot be read: "),
        ("bad.stl", b"", "holds no triangles"),
        ("bad.stl", b"solid x\nendsolid x\n", "holds no triangles"),
    ],
)
def test_a_broken_mesh_is_a_world_error_with_its_path(write, tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    path = write(furniture={"thing": {"mesh": name, "at": [4, 3, 0]}})
    with pytest.raises(WorldError, match=rf"{name} {words}"):
        draw_episode(path, 0)


def test_a_mesh_that_is_not_there_is_told_at_its_place(write):
    path = write(furniture={"thing": {"mesh": "none.glb", "at": [4, 3, 0]}})
    with pytest.raises(WorldFileError, match=r"world.yaml:\d+:\d+: there is no file 'none.glb'"):
        load_world(path)
    path = write(furniture={"thing": {"mesh": "chair.fbx", "at": [4, 3, 0]}})
    with pytest.raises(WorldFileError, match=r"not a mesh file; endings: .glb"):
        load_world(path)
