"""Cutting a URDF down to the base: what hangs below stays, what is above goes."""

from __future__ import annotations

import math
from pathlib import Path

import pinocchio as pin
import pytest
from momantu_skills.manipulation.model.urdf import BaseUrdf, base_urdf

from momantu_bt.geometry import Transform
from momantu_bt.testing import small_robot

VIRTUAL = """
<link name="root"/>
<joint name="drive" type="prismatic"><parent link="root"/><child link="{base}"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
"""
ARM = """
<link name="{base}">{shape}</link>
<link name="wheel"/>
<joint name="spin" type="continuous"><parent link="{base}"/><child link="wheel"/>
  <axis xyz="0 0 1"/>{limit}</joint>
<link name="rim"/>
<joint name="bend" type="revolute"><parent link="wheel"/><child link="rim"/>
  <axis xyz="0 1 0"/><limit lower="-0.5" upper="1.5" effort="1" velocity="1"/></joint>
<link name="beside"/>
"""


def cut(folder: Path, shape: str = "", limit: str = "", virtual: str = VIRTUAL) -> BaseUrdf:
    description = small_robot()
    body = (virtual + ARM).format(base=description.base_frame, shape=shape, limit=limit)
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="small">{body}</robot>')
    return base_urdf(description.model_copy(update={"urdf": path}))


@pytest.mark.parametrize("virtual", ["", VIRTUAL])
def test_what_is_above_or_beside_the_base_goes(tmp_path: Path, virtual: str) -> None:
    model = pin.buildModelFromXML(cut(tmp_path, virtual=virtual).text)
    assert list(model.names) == ["universe", "spin", "bend"]
    assert model.existFrame(small_robot().base_frame)
    assert not model.existFrame("root")
    assert not model.existFrame("beside")


@pytest.mark.parametrize("limit", ["", '<limit effort="1" velocity="2" lower="0" upper="0"/>'])
def test_an_endless_joint_becomes_one_coordinate_of_a_whole_turn(
    tmp_path: Path, limit: str
) -> None:
    urdf = cut(tmp_path, limit=limit)
    model = pin.buildModelFromXML(urdf.text)
    assert urdf.continuous == ("spin",)
    assert model.nq == model.nv == 2
    assert model.lowerPositionLimit.tolist() == pytest.approx([-math.pi, -0.5])
    assert model.upperPositionLimit.tolist() == pytest.approx([math.pi, 1.5])


@pytest.mark.parametrize(
    ("geometry", "kind", "size"),
    [
        ('<box size="0.1 0.2 0.3"/>', "box", (0.1, 0.2, 0.3)),
        ('<cylinder radius="0.1" length="0.4"/>', "cylinder", (0.1, 0.4, 0.0)),
        ('<sphere radius="0.2"/>', "sphere", (0.2, 0.0, 0.0)),
    ],
)
def test_shapes_are_read_with_their_place(
    tmp_path: Path, geometry: str, kind: str, size: tuple[float, float, float]
) -> None:
    placed = '<collision><origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><geometry>{}</geometry></collision>'
    bare = "<collision><geometry>{}</geometry></collision><collision/>"
    first, second = cut(tmp_path, (placed + bare).format(geometry, geometry)).parts
    assert first.link == second.link == small_robot().base_frame
    assert first.kind == second.kind == kind
    assert first.size == second.size == size
    assert first.link_from_part == Transform.from_rpy((1, 2, 3), (0.1, 0.2, 0.3))
    assert second.link_from_part == Transform()


def test_meshes_are_looked_for_beside_the_urdf_and_in_the_mesh_folders(tmp_path: Path) -> None:
    mesh = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "a.stl").write_bytes(b"")
    for name in ("meshes/a.stl", "package://meshes/a.stl", "file://meshes/a.stl"):
        (part,) = cut(tmp_path, mesh.format(name)).parts
        assert part.mesh == tmp_path / "meshes" / "a.stl"
        assert part.size == (1.0, 1.0, 1.0)
    with pytest.raises(FileNotFoundError, match=r"b\.stl.*not in") as caught:
        cut(tmp_path, mesh.format("package://meshes/b.stl"))
    assert str(tmp_path) in str(caught.value)


def test_a_file_cannot_pull_in_others(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("0.5")
    description = small_robot()
    path = tmp_path / "robot.urdf"
    path.write_text(
        f'<!DOCTYPE r [<!ENTITY other SYSTEM "{secret}">]><robot name="r">'
        f'<link name="{description.base_frame}"><inertial>&other;</inertial></link></robot>'
    )
    assert "0.5" not in base_urdf(description.model_copy(update={"urdf": path})).text
