"""Mesh files lie, stand and measure in a world as their formats say."""

import numpy as np
import pytest
import trimesh
from momantu_worlds.sdf.mesh.collada import Z_FROM, BadMesh, collada_notes
from momantu_worlds.sdf.mesh.files import Piece, read_mesh
from momantu_worlds.sdf.mesh.reducing import count, reduced
from momantu_worlds.sdf.read.model import MeshFile

RED = [255, 0, 0, 255]


def colored(mesh, color):
    material = trimesh.visual.material.PBRMaterial(baseColorFactor=color)
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    return mesh


@pytest.fixture
def dae(tmp_path):
    """A box of 1 x 2 x 3 on the origin, with an asset of one's own."""

    def write(asset="", name="box.dae"):
        mesh = trimesh.creation.box((1, 2, 3))
        mesh.apply_translation((0, 0, 1.5))
        text = trimesh.exchange.dae.export_collada(colored(mesh, RED)).decode()
        file = tmp_path / name
        file.write_text(text.replace("<up_axis>Y_UP</up_axis>", asset))
        return file

    return write


def extent(read):
    points = np.concatenate([piece.vertices for piece in read.pieces])
    return points.min(axis=0).tolist(), points.max(axis=0).tolist()


def test_collada_is_measured_in_metres(dae):
    file = dae('<unit name="inch" meter="0.5"/><up_axis>Z_UP</up_axis>')
    found = read_mesh(MeshFile(file), heed_up=True)
    assert extent(found) == ([-0.25, -0.5, 0], [0.25, 0.5, 1.5])
    assert found.up == ""
    assert found.pieces[0].color == (1, 0, 0)


def test_y_up_becomes_z_up_where_that_is_wanted(dae):
    found = read_mesh(MeshFile(dae("<up_axis>Y_UP</up_axis>")), heed_up=True)
    low, high = extent(found)
    assert low == pytest.approx([-0.5, -3, -1])
    assert high == pytest.approx([0.5, 0, 1])
    plain = read_mesh(MeshFile(dae("<up_axis>Y_UP</up_axis>")))
    assert extent(plain) == ([-0.5, -1, 0], [0.5, 1, 3])
    assert found.up == plain.up == "Y_UP"
    assert extent(read_mesh(MeshFile(dae()), heed_up=True)) == extent(plain)


def test_turns_are_turns_that_bring_the_named_axis_up():
    for name, up in (("X_UP", 0), ("Y_UP", 1), ("Z_UP", 2)):
        turn = Z_FROM[name]
        assert turn @ np.eye(3)[up] == pytest.approx([0, 0, 1])
        assert np.linalg.det(turn) == pytest.approx(1)


@pytest.mark.parametrize("ending", ["stl", "obj", "ply"])
def test_other_formats_are_taken_as_they_are(tmp_path, ending):
    file = tmp_path / f"box.{ending}"
    trimesh.creation.box((1, 2, 3)).export(file)
    found = read_mesh(MeshFile(file, scale=(1, 1, 2)))
    assert extent(found) == ([-0.5, -1, -3], [0.5, 1, 3])


def test_gltf_has_y_up(tmp_path):
    file = tmp_path / "box.glb"
    trimesh.creation.box((1, 2, 3)).export(file)
    assert extent(read_mesh(MeshFile(file)))[1] == pytest.approx([0.5, 1.5, 1])


def test_an_obj_brings_its_materials(tmp_path):
    (tmp_path / "two.mtl").write_text("newmtl a\nKd 0 1 0\nnewmtl b\nKd 0 0 1\n")
    (tmp_path / "two.obj").write_text(
        "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        "o left\nusemtl a\nf 1 2 3\no right\nusemtl b\nf 1 2 4\n"
    )
    found = read_mesh(MeshFile(tmp_path / "two.obj"))
    assert sorted(p.color for p in found.pieces) == [(0, 0, 1), (0, 1, 0)]
    right = read_mesh(MeshFile(tmp_path / "two.obj", submesh="right"))
    assert extent(right)[1] == [1, 0, 1]


def test_a_mirrored_mesh_still_faces_outwards(tmp_path):
    file = tmp_path / "box.stl"
    trimesh.creation.box((1, 2, 3)).export(file)
    (piece,) = read_mesh(MeshFile(file, scale=(-1, 1, 1))).pieces
    assert trimesh.Trimesh(piece.vertices, piece.triangles).volume == pytest.approx(6)


SCENE = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Z_UP</up_axis></asset>
<library_geometries>{geometries}</library_geometries>
<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
GEOMETRY = """<geometry id="{name}-mesh" name="{name}"><mesh><source id="{name}-p">
<float_array id="{name}-a" count="9">0 0 {z} 1 0 {z} 0 1 {z}</float_array><technique_common>
<accessor source="#{name}-a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="{name}-v"><input semantic="POSITION" source="#{name}-p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#{name}-v" offset="0"/><p>0 1 2</p>
</triangles></mesh></geometry>"""


def scene(tmp_path, nodes):
    geometries = "".join(GEOMETRY.format(name=name, z=z) for name, z in (("low", 1), ("high", 4)))
    file = tmp_path / "scene.dae"
    file.write_text(SCENE.format(geometries=geometries, nodes=nodes))
    return file


def test_a_submesh_is_found_by_the_name_of_its_node(tmp_path):
    nodes = "".join(
        f'<node id="n{name}" name="{node}"><instance_geometry url="#{name}-mesh"/></node>'
        for name, node in (("low", "Leg"), ("high", "Top"))
    )
    file = scene(tmp_path, nodes)
    for name in ("Top", "nhigh", "high", "high-mesh"):
        assert extent(read_mesh(MeshFile(file, submesh=name))) == ([0, 0, 4], [1, 1, 4]), name
    middle = read_mesh(MeshFile(file, submesh="Top", center=True))
    assert extent(middle) == ([-0.5, -0.5, 0], [0.5, 0.5, 0])
    with pytest.raises(BadMesh, match="no submesh 'Lid'; it has: .*Top"):
        read_mesh(MeshFile(file, submesh="Lid"))


def test_scenes_that_use_themselves_or_multiply_are_refused(tmp_path):
    loop = (
        '<node id="a"><instance_node url="#b"/></node><node id="b"><instance_node url="#a"/></node>'
    )
    with pytest.raises(BadMesh, match="uses itself"):
        collada_notes(scene(tmp_path, loop))
    many = "".join(
        f'<node id="n{n}"><instance_node url="#n{n + 1}"/><instance_node url="#n{n + 1}"/></node>'
        for n in range(40)
    )
    many += '<node id="n40"><instance_geometry url="#low-mesh"/></node>'
    with pytest.raises(BadMesh, match="more than 20000 geometries"):
        collada_notes(scene(tmp_path, many))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.stl", b"solid nothing", "cannot be read|no triangles"),
        ("a.obj", b"v 0 0 0\n", "cannot be read|no triangles"),
        ("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not numbers"),
        ("a.obj", b"v 1e9 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "farther than"),
        ("a.dae", b"<COLLADA>", "not XML"),
        ("a.dae", b"<COLLADA/>", "cannot be read|no triangles"),
        ("a.dae", b"<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA>&b;</COLLADA>", "entities of its own"),
        ("a.dae", b"<x>" * 200, "100 elements within each other"),
        ("a.dae", b"<COLLADA><asset><unit meter='zero'/></asset></COLLADA>", "unit is 'zero'"),
        ("a.dae", b"<COLLADA><asset><up_axis>UP</up_axis></asset></COLLADA>", "<up_axis> is 'UP'"),
        ("a.glb", b"glTF", "cannot be read"),
        ("a.fbx", b"", "end with '.fbx' are not read"),
    ],
)
def test_broken_files_are_told(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadMesh, match=words):
        read_mesh(MeshFile(tmp_path / name))


def test_a_huge_file_is_not_read(tmp_path):
    file = tmp_path / "huge.stl"
    with file.open("wb") as stream:
        stream.truncate(100_000_000)
    with pytest.raises(BadMesh, match="100000000 bytes"):
        read_mesh(MeshFile(file))


def test_big_meshes_keep_their_form_and_lose_triangles():
    ball = trimesh.creation.icosphere(subdivisions=5)
    piece = Piece(np.asarray(ball.vertices), np.asarray(ball.faces))
    few = reduced([piece], 3000)
    assert 500 < count(few) <= 3000
    radii = np.linalg.norm(few[0].vertices, axis=1)
    assert radii == pytest.approx(np.ones(len(radii)))
    again = trimesh.Trimesh(few[0].vertices, few[0].triangles)
    assert again.volume == pytest.approx(ball.volume, rel=0.02)
    assert reduced([piece], 10**6)[0] is piece


def test_pictures_are_found_where_gazebo_looks_for_them(tmp_path):
    """Beside the mesh by its path, or in the model's folder of textures; nowhere else."""
    from PIL import Image

    meshes, textures = tmp_path / "chair" / "meshes", tmp_path / "chair" / "materials" / "textures"
    meshes.mkdir(parents=True)
    textures.mkdir(parents=True)
    Image.new("RGB", (2, 2), (9, 8, 7)).save(textures / "wood.png")
    Image.new("RGB", (2, 2), (1, 1, 1)).save(tmp_path / "secret.png")
    (meshes / "chair.obj").write_text(
        "mtllib chair.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
        "usemtl m\nf 1/1 2/2 3/3\n"
    )
    for said, found in (
        ("../materials/textures/wood.png", True),
        ("wood.png", True),
        ("C:\\old\\wood.png", True),
        ("none.png", False),
        ("../../secret.png", False),
        (f"{tmp_path}/secret.png", False),
    ):
        (meshes / "chair.mtl").write_text(f"newmtl m\nKd 1 1 1\nmap_Kd {said}\n")
        read = read_mesh(MeshFile(meshes / "chair.obj"))
        picture = read.pieces[0].picture
        assert (picture is not None) == found, said
        assert bool(read.missing) != found, said
        if found:
            assert picture.convert("RGB").getpixel((0, 0)) == (9, 8, 7)
