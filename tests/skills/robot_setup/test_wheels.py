"""How a base drives: told from the axes of its wheels, and from names in its URDF."""

from __future__ import annotations

import math

import pytest
from lxml import etree
from momantu_skills.robot_setup.find.base import find_stand
from momantu_skills.robot_setup.find.wheels import Driving, find_driving

from momantu_bt.robot import BaseKind
from tests.skills.robot_setup.conftest import body_of, box, joint, link

CHASSIS = link("base_link", box(0.6, 0.5, 0.2), "0 0 0.25", 30)
CORNERS = ((0.2, 0.2), (0.2, -0.2), (-0.2, 0.2), (-0.2, -0.2))


def wheel(name: str, on: str, x: float, y: float, yaw: float = 0.0, z: float = 0.1) -> list[str]:
    """Turns about its y, and yaw turns it about the vertical."""
    shape = '<cylinder radius="0.1" length="0.04"/>'
    at, rpy = f"{x} {y} {z}", f"0 0 {yaw}"
    return [
        link(name, shape, rpy="1.5708 0 0"),
        joint(f"{name}_joint", on, name, at, "0 1 0", "continuous", rpy=rpy),
    ]


def driving(*elements: str, virtual: bool = False) -> Driving:
    body = body_of(CHASSIS, *elements)
    document = etree.fromstring(f"<robot>{''.join(elements)}</robot>")
    return find_driving(body, document, find_stand(body).wheels, virtual)


def parallel(word: str = "wheel") -> list[str]:
    every = [wheel(f"{word}_{k}", "base_link", *at) for k, at in enumerate(CORNERS)]
    return [part for each in every for part in each]


def steered(count: int) -> list[str]:
    """Forks that turn, each with a wheel; the other wheels are fixed to the base."""
    parts = []
    for k, (x, y) in enumerate(CORNERS):
        if k >= count:
            parts += wheel(f"wheel_{k}", "base_link", x, y)
            continue
        turns = joint(
            f"fork_{k}_joint", "base_link", f"fork_{k}", f"{x} {y} 0.1", kind="continuous"
        )
        parts += [link(f"fork_{k}"), turns, *wheel(f"wheel_{k}", f"fork_{k}", 0.0, 0.0, 0.0, 0.0)]
    return parts


def test_parallel_wheels_do_not_drive_sideways() -> None:
    found = driving(*parallel())
    assert found.kind is BaseKind.DIFFERENTIAL


@pytest.mark.parametrize("start", [0.0, 0.4, -2.0])
def test_three_wheels_with_axes_in_several_directions_do(start: float) -> None:
    turns = [start + 2.0 * math.pi * k / 3.0 for k in range(3)]
    parts = [
        part
        for k, turn in enumerate(turns)
        for part in wheel(f"w{k}", "base_link", 0.2 * math.sin(turn), -0.2 * math.cos(turn), turn)
    ]
    found = driving(*parts)
    assert (found.kind, found.measured) == (BaseKind.OMNIDIRECTIONAL, True)


def test_wheels_that_are_all_steered_drive_sideways() -> None:
    found = driving(*steered(4))
    assert (found.kind, found.measured) == (BaseKind.OMNIDIRECTIONAL, True)


def test_casters_beside_fixed_wheels_do_not_drive_sideways() -> None:
    assert driving(*steered(2)).kind is BaseKind.DIFFERENTIAL


def pair(on: str) -> list[str]:
    return [part for y in (0.2, -0.2) for part in wheel(f"w{y > 0}", on, 0.1, y, 0.0, 0.0)]


def test_two_wheels_on_a_turntable_drive_sideways() -> None:
    turns = joint("turn", "base_link", "table", "0 0 0.1", kind="continuous")
    found = driving(link("table"), turns, *pair("table"))
    assert (found.kind, found.measured) == (BaseKind.OMNIDIRECTIONAL, True)
    still = joint("turn", "base_link", "table", "0 0 0.1", kind="fixed")
    assert driving(link("table"), still, *pair("table")).kind is BaseKind.DIFFERENTIAL


def test_a_ball_that_rolls_about_three_axes_is_a_wheel() -> None:
    ball = link("ball", '<sphere radius="0.05"/>')
    parts = [link("a"), link("b"), ball]
    for name, on, axis in (
        ("a", "base_link", "1 0 0"),
        ("b", "a", "0 1 0"),
        ("ball", "b", "0 0 1"),
    ):
        at = "0.2 0 0.05" if name == "a" else "0 0 0"
        parts.append(joint(f"{name}_joint", on, name, at, axis, "continuous"))
    body = body_of(CHASSIS, *parts, *wheel("w", "base_link", -0.2, 0.0))
    stand = find_stand(body)
    assert {"ball", "w"} <= set(stand.wheels)
    assert {"ball", "w"} <= set(stand.grounded)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (
            [*parallel(), '<gazebo><plugin filename="libgazebo_ros_planar_move.so"/></gazebo>'],
            "libgazebo_ros_planar_move.so",
        ),
        (parallel("mecanum_wheel"), "mecanum_wheel_0"),
    ],
)
def test_names_tell_of_rollers(parts: list[str], said: str) -> None:
    found = driving(*parts)
    assert (found.kind, found.measured) == (BaseKind.OMNIDIRECTIONAL, False)
    assert said in found.why


def test_a_base_on_slides_without_wheels_drives_sideways() -> None:
    assert driving(virtual=True).kind is BaseKind.OMNIDIRECTIONAL
    assert driving(*parallel(), virtual=True).kind is BaseKind.DIFFERENTIAL


def test_wheels_on_a_suspension_are_wheels() -> None:
    rocker = joint("rocker", "base_link", "axle", "0.2 0 0.1", "1 0 0")
    sides = [part for y in (0.3, -0.3) for part in wheel(f"w{y > 0}", "axle", 0.0, y, 0.0, 0.0)]
    body = body_of(CHASSIS, link("axle"), rocker, *sides)
    assert set(find_stand(body).wheels) == {"wTrue", "wFalse"}
