"""Meshes are found where URDFs of ROS packages expect them, and a user's own take their place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree

from momantu_bt.robots import RobotFileError, read_robot

Write = Callable[..., Path]
SPHERE = '<sphere radius="0.03"/>'


def mesh_files(robot: Path, link: str, tag: str) -> list[str]:
    root = etree.fromstring(read_robot(robot).urdf.read_bytes())
    found = root.xpath(f"link[@name='{link}']/{tag}/geometry/mesh/@filename")
    return [str(each) for each in found]  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("hull.stl", "carter/hull.stl"),
        ("meshes/hull.stl", "carter/meshes/hull.stl"),
        ("package://arm_description/meshes/hull.stl", "carter/arm_description/meshes/hull.stl"),
        ("package://carter/hull.stl", "carter/hull.stl"),
        ("package:///carter/hull.stl", "carter/hull.stl"),
    ],
)
def test_a_mesh_is_found(carter: Write, tmp_path: Path, name: str, where: str) -> None:
    file = carter(arm=(SPHERE, f'<mesh filename="{name}"/>'))
    mesh = tmp_path / where
    mesh.parent.mkdir(parents=True, exist_ok=True)
    mesh.write_bytes(b"solid")
    assert set(mesh_files(file, "arm_forearm", "visual")) == {str(mesh)}
    assert mesh in read_robot(file).files.values()
    assert "hull.stl" not in " ".join(read_robot(file).texts())


def test_a_missing_mesh_is_told_with_where_it_was_looked_for(carter: Write) -> None:
    file = carter(cart=('<box size="0.5 0.4 0.2"/>', '<mesh filename="package://cart/body.dae"/>'))
    with pytest.raises(RobotFileError, match=r"cart.urdf:7: .*body.dae' is missing; .*carter"):
        read_robot(file)


@pytest.fixture
def own(tmp_path: Path) -> Path:
    folder = tmp_path / "mine" / "carter" / "arm"
    (folder / "collision").mkdir(parents=True)
    (folder / "forearm.glb").touch()
    (folder / "collision" / "forearm.STL").touch()
    return folder


def test_a_users_meshes_take_the_place_of_a_links_geometry(carter: Write, own: Path) -> None:
    file = carter(robot=("namespace: arm,", f"namespace: arm, meshes: {own},"))
    assert mesh_files(file, "arm_forearm", "visual") == [str(own / "forearm.glb")]
    assert mesh_files(file, "arm_forearm", "collision") == [str(own / "collision" / "forearm.STL")]
    root = etree.fromstring(read_robot(file).urdf.read_bytes())
    assert len(root.xpath("link[@name='arm_forearm']/visual/geometry/*")) == 1  # type: ignore[arg-type]
    assert mesh_files(file, "arm_shoulder", "visual") == []


def test_the_environment_gives_meshes_without_touching_the_file(
    carter: Write, own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = carter()
    plain = read_robot(file)
    monkeypatch.setenv("MOMANTU_BT_MESHES", str(own.parent.parent))
    assert mesh_files(file, "arm_forearm", "visual") == [str(own / "forearm.glb")]
    assert read_robot(file).urdf != plain.urdf


def test_a_folder_with_nothing_that_fits_is_refused(carter: Write, tmp_path: Path) -> None:
    (tmp_path / "carter").mkdir()
    (tmp_path / "carter" / "empty").mkdir()
    file = carter(robot=("namespace: arm,", "namespace: arm, meshes: empty,"))
    with pytest.raises(RobotFileError, match="6:.*no mesh in .*empty is called like .*forearm"):
        read_robot(file)
    file = carter(robot=("namespace: arm,", "namespace: arm, meshes: none,"))
    with pytest.raises(RobotFileError, match="there is no folder .*none"):
        read_robot(file)


def test_a_texture_is_found_like_a_mesh_or_left_out(carter: Write, tmp_path: Path) -> None:
    """The simulator ended in a filesystem error where it did not find the picture."""
    robot = carter()
    picture = tmp_path / "carter" / "looks" / "paint.png"
    picture.parent.mkdir()
    picture.write_bytes(b"")
    cart = tmp_path / "carter" / "cart.urdf"
    materials = "".join(
        f'<material name="{name}"><texture filename="package://looks/{name}.png"/></material>'
        for name in ("paint", "gone")
    )
    cart.write_text(cart.read_text().replace("</robot>", f"{materials}</robot>"))
    root = etree.fromstring(read_robot(robot).urdf.read_bytes())
    assert [texture.get("filename") for texture in root.iter("texture")] == [str(picture)]
