"""URDFs as links and joints: what is written is read, and what is not a number is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from momantu_bt.formats.urdf import Mimic, Shape, Urdf, UrdfError, linked, parse_urdf, read_urdf

ROBOT = """
<robot name="r"><!-- by hand -->
  <link name="base">
    <inertial><mass value="2.5"/></inertial>
    <visual/><visual/>
    <collision>
      <origin xyz="1 2 3" rpy="0.1 0 0"/><geometry><box size="1 2 3"/></geometry>
    </collision>
    <collision><geometry><mesh filename="package://a.stl"/></geometry></collision>
    <collision><geometry><capsule radius="1"/></geometry></collision>
    <collision/>
  </link>
  <link name="tip"><inertial><mass value="0.5"/></inertial></link>
  <joint name="bend" type="revolute">
    <parent link="base"/><child link="tip"/><origin xyz="0 0 0.5"/>
    <limit lower="-1" effort="3"/><mimic joint="other" multiplier="-2"/>
  </joint>
</robot>
"""


def urdf(text: str) -> Urdf:
    return Urdf(parse_urdf(text.encode(), "r.urdf"))


def test_links_and_joints_are_read() -> None:
    robot = urdf(ROBOT)
    base, tip = robot.links
    assert (base.name, base.mass, base.visuals, base.collisions) == ("base", 2.5, 2, 4)
    assert base.shapes == (
        Shape("box", (1.0, 2.0, 3.0), (0.1, 0.0, 0.0), (1.0, 2.0, 3.0)),
        Shape("mesh", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), "package://a.stl"),
    )
    assert (tip.visuals, tip.shapes, robot.mass) == (0, (), 3.0)
    (bend,) = robot.joints
    assert (bend.name, bend.kind, bend.parent, bend.child) == ("bend", "revolute", "base", "tip")
    assert (bend.xyz, bend.rpy, bend.axis) == ((0.0, 0.0, 0.5), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    assert (bend.lower, bend.upper, bend.velocity, bend.effort) == (-1.0, None, None, 3.0)
    assert bend.mimic == Mimic("other", -2.0, 0.0)


def test_what_nobody_asks_for_may_be_wrong() -> None:
    robot = urdf(ROBOT.replace('"2.5"', '"heavy"'))
    assert len(robot.joints) == 1
    with pytest.raises(UrdfError, match="the link base has mass='heavy'; write a number"):
        _ = robot.links


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('lower="-1"', 'lower="inf"', "the joint bend has lower='inf'; write a number"),
        ('effort="3"', 'effort="-3"', "effort='-3'; write a number of 0 or more"),
        ('xyz="0 0 0.5"', 'xyz="0 0"', "the joint bend has xyz='0 0'; write three numbers"),
        ('multiplier="-2"', 'multiplier=""', "multiplier=''; write a number"),
    ],
)
def test_what_is_no_number_is_named(old: str, new: str, words: str) -> None:
    with pytest.raises(UrdfError, match=words):
        _ = urdf(ROBOT.replace(old, new)).joints


def test_a_joint_without_ends_has_empty_ones() -> None:
    root = parse_urdf(b"<robot><joint/></robot>", "r.urdf")
    assert linked(root[0], "parent") == linked(root[0], "child") == ""


def test_what_is_no_xml_is_refused_and_nothing_else_is_read(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text("<robot>")
    with pytest.raises(UrdfError, match=r"r\.urdf is not a URDF file, for it is not XML"):
        read_urdf(file)
    (tmp_path / "secret").write_text("0.5")
    entity = f'<!DOCTYPE r [<!ENTITY other SYSTEM "{tmp_path / "secret"}">]>'
    file.write_text(f"{entity}<robot><link name='a'><inertial>&other;</inertial></link></robot>")
    assert read_urdf(file).links[0].mass == 0.0
