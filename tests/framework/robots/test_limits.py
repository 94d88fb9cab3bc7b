"""Laws of limits that a URDF leaves out: the robot file gives them, and changes no others."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from momantu_bt.robot_parts import JointLimit
from momantu_bt.robots import read_robot
from momantu_bt.robots.limits import complete_limits, has_range

Write = Callable[..., Path]
TURN = '<limit lower="-2" upper="2" velocity="1" effort="50"/>'
EMPTY = {
    "none": "",
    "no ends": '<limit velocity="1" effort="50"/>',
    "from 0 to 0": '<limit lower="0" upper="0" velocity="1" effort="50"/>',
}
GIVEN = JointLimit(lower=-1.0, upper=0.5, velocity=0.7, acceleration=1.0)
ENDLESS = JointLimit(velocity=0.7, acceleration=1.0)

NUMBER = st.floats(-7, 7).map(lambda x: f"{x:.3f}")
LIMIT = st.fixed_dictionaries(
    {},
    optional={"lower": NUMBER, "upper": NUMBER, "velocity": NUMBER, "effort": NUMBER},
)
KIND = st.sampled_from(["revolute", "prismatic", "continuous", "fixed"])
FROM_FILE = st.sampled_from([None, GIVEN, ENDLESS])


def joint(kind: str, limit: str | dict[str, str] | None) -> etree._Element:
    element = etree.fromstring(f'<joint name="j" type="{kind}"/>')
    if isinstance(limit, str) and limit:
        element.append(etree.fromstring(limit))
    elif isinstance(limit, dict):
        etree.SubElement(element, "limit", limit)
    return element


@given(KIND, st.one_of(st.none(), LIMIT), FROM_FILE)
def test_what_a_urdf_says_stays_and_what_a_hinge_or_slide_needs_is_there(
    kind: str, limit: dict[str, str] | None, given: JointLimit | None
) -> None:
    element = joint(kind, limit)
    before = etree.tostring(element)
    changed = complete_limits([element], {} if given is None else {"j": given})
    assert changed == (etree.tostring(element) != before)
    if kind in ("continuous", "fixed"):
        assert not changed
        return
    found = element.find("limit")
    assert found is not None
    kept = {"effort", "velocity"} & set(limit or ())
    kept |= {"lower", "upper"} if has_range(joint(kind, limit or {})[0]) else set()
    for name in kept:
        assert found.get(name) == (limit or {}).get(name)
    assert {"effort", "velocity"} <= set(found.keys())
    if given is GIVEN:
        assert has_range(found)
    assert not complete_limits([element], {} if given is None else {"j": given})


@pytest.mark.parametrize("limit", EMPTY.values(), ids=EMPTY.keys())
def test_a_hinge_without_a_range_has_the_robot_files(limit: str) -> None:
    element = joint("revolute", limit)
    complete_limits([element], {"j": GIVEN})
    found = element.find("limit")
    assert found is not None
    assert (found.get("lower"), found.get("upper")) == ("-1.0", "0.5")
    assert found.get("velocity") == ("1" if limit else "0.7")
    assert found.get("effort") == ("50" if limit else "0")


@pytest.mark.parametrize("limit", EMPTY.values(), ids=EMPTY.keys())
def test_a_hinge_without_ends_anywhere_turns_for_ever_and_a_slide_does_not(limit: str) -> None:
    hinge, slide = joint("revolute", limit), joint("prismatic", limit)
    complete_limits([hinge, slide], {"j": ENDLESS})
    assert (hinge.get("type"), slide.get("type")) == ("continuous", "prismatic")


@pytest.mark.parametrize("limit", EMPTY.values(), ids=EMPTY.keys())
def test_a_robot_with_such_a_hinge_is_read_with_the_range_of_its_file(
    carter: Write, limit: str
) -> None:
    robot = read_robot(carter(arm=(TURN, limit)))
    hinge = etree.fromstring(robot.urdf.read_bytes()).find("joint[@name='arm_turn']/limit")
    assert hinge is not None
    ends = [float(str(hinge.get(end))) for end in ("lower", "upper")]
    assert ends == pytest.approx([-math.pi / 2, math.pi / 2])


def test_a_whole_urdf_that_lacks_nothing_is_used_as_it_is(tmp_path: Path) -> None:
    from momantu_bt.testing import small_robot

    urdf = small_robot().urdf
    joints = etree.fromstring(urdf.read_bytes()).findall("joint")
    assert not complete_limits(joints, small_robot().joint_limits)
