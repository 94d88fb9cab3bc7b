"""A stranger's URDF is mended before anything is measured, and every mending is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree
from momantu_skills.robot_setup.urdf.prepare import Prepared, prepare
from momantu_skills.robot_setup.urdf.skeleton import SetupError

from momantu_bt.robots.inertia import impossible_inertials

Given = Callable[..., Prepared]
BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'


@pytest.fixture
def given(tmp_path: Path) -> Given:
    """What becomes of a URDF of two links, `a` carrying `b`."""

    def make(kind: str = "revolute", limit: str = "", shapes: str = BOX) -> Prepared:
        source, folder = tmp_path / "r.urdf", tmp_path / "cleaned"
        folder.mkdir(exist_ok=True)
        joint = f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/>{limit}</joint>'
        links = f'<link name="a">{shapes}</link><link name="b"/>'
        source.write_text(f'<robot name="r">{links}{joint}</robot>')
        return prepare(source, folder)

    return make


def joint_of(prepared: Prepared) -> etree._Element:
    found = etree.parse(prepared.urdf).find("joint")
    assert found is not None
    return found


LIMITED = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'
MENDED = {
    "a type that is none": ("elastic", LIMITED, "fixed", "unknown type 'elastic'; taken as fixed"),
    "a hinge without limits": ("revolute", "", "revolute", "j has no limits in the URDF"),
    "a slide without limits": ("prismatic", "", "fixed", "leave it no room; taken as fixed"),
    "half a range": ("revolute", '<limit lower="-1"/>', "revolute", "j has no limits"),
    "a slide without room": ("prismatic", '<limit lower="0" upper="0"/>', "fixed", "no room"),
    "a hinge with hardly any": ("revolute", '<limit lower="0" upper="1e-5"/>', "fixed", "no room"),
}


@pytest.mark.parametrize(("kind", "limit", "becomes", "words"), MENDED.values(), ids=MENDED)
def test_joints_are_mended_and_told(
    given: Given, kind: str, limit: str, becomes: str, words: str
) -> None:
    prepared = given(kind, limit)
    assert joint_of(prepared).get("type") == becomes
    assert any(words in note for note in prepared.notes)


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous", "fixed"])
def test_what_is_right_stays_and_nothing_is_said(given: Given, kind: str) -> None:
    prepared = given(kind, LIMITED)
    assert prepared.notes == ()
    limit = joint_of(prepared).find("limit")
    assert limit is not None
    numbers = [limit.get(name) for name in ("lower", "upper", "velocity", "effort")]
    assert numbers == ["-1", "2", "3", "4"]


def test_a_range_that_a_hinge_lacks_is_half_a_turn_either_way(given: Given) -> None:
    limit = joint_of(given("revolute")).find("limit")
    assert limit is not None
    low, high = (float(limit.get(end, "nan")) for end in ("lower", "upper"))
    assert -low == high == pytest.approx(3.14159, abs=1e-4)
    assert (limit.get("effort"), limit.get("velocity")) == ("0", "0")


def shape(text: str) -> str:
    return f"<collision><geometry>{text}</geometry></collision>"


FLAT = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
SHAPES = {
    "nothing": ("<collision/>", "a collision of a is nothing; left out"),
    "no shape of URDF's": (shape("<plane/>"), "a collision of a is <plane>; left out"),
    "not there": (
        shape('<mesh filename="gone.obj"/>'),
        "the collision mesh gone.obj was not found",
    ),
    "flat": (shape('<mesh filename="flat.obj"/>'), "of a has no volume; left out"),
    "not a mesh": (shape('<mesh filename="words.obj"/>'), "a collision mesh of a "),
}


@pytest.mark.parametrize(("shapes", "words"), SHAPES.values(), ids=SHAPES)
def test_shapes_around_which_no_hull_goes_are_left_out_and_told(
    given: Given, tmp_path: Path, shapes: str, words: str
) -> None:
    (tmp_path / "flat.obj").write_text(FLAT)
    (tmp_path / "words.obj").write_text("these are words\n")
    prepared = given("fixed", shapes=shapes + BOX)
    assert any(words in note for note in prepared.notes)
    assert len(etree.parse(prepared.urdf).findall("link/collision")) == 1


def test_many_missing_meshes_are_told_in_one_line(given: Given) -> None:
    gone = "".join(shape(f'<mesh filename="package://arm/{n}.stl"/>') for n in range(5))
    (note,) = given("fixed", shapes=gone).notes
    assert note.startswith("5 collision meshes were not found")
    assert "package://arm/0.stl, package://arm/1.stl, package://arm/2.stl, …" in note


def test_what_is_no_urdf_is_refused(tmp_path: Path) -> None:
    for name, text in (("r.urdf", "no XML"), ("r.urdf", "<sdf/>"), ("r.xacro", "<robot>")):
        (tmp_path / name).write_text(text)
        with pytest.raises(SetupError, match=name):
            prepare(tmp_path / name, tmp_path)
    with pytest.raises(SetupError, match=r"gone\.urdf"):
        prepare(tmp_path / "gone.urdf", tmp_path)


def test_an_impossible_inertia_becomes_a_boxes_and_is_told_by_link(tmp_path: Path) -> None:
    shape = '<collision><geometry><box size="0.2 0.1 0.4"/></geometry></collision>'
    zero = '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
    bad = f'<inertial><mass value="2"/>{zero}</inertial>'
    text = (
        f'<robot name="r"><link name="base"/><link name="arm">{bad}{shape}</link>'
        f'<link name="tip">{shape}</link><joint name="j" type="continuous"><parent link="base"/>'
        '<child link="arm"/></joint><joint name="k" type="continuous"><parent link="arm"/>'
        '<child link="tip"/></joint></robot>'
    )
    (tmp_path / "r.urdf").write_text(text)
    prepared = prepare(tmp_path / "r.urdf", tmp_path)
    mended = prepared.given.inertials
    assert set(mended) == {"arm", "tip"}
    assert mended["arm"].mass == 2
    assert mended["arm"].box == pytest.approx((0.2, 0.1, 0.4))
    assert mended["tip"].mass == pytest.approx(500 * 0.2 * 0.1 * 0.4)
    assert all(any(f"'{name}'" in note for note in prepared.notes) for name in mended)
    assert impossible_inertials(prepared.document) == {}
