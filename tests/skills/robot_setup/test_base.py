"""How a robot stands: laws of footprints around random bases, and what counts as a wheel."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.robot_setup.find.base import CORNERS, find_base, find_stand, outline, planar
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array
from tests.skills.robot_setup.conftest import body_of, box, joint, link

WHOLE = 0.0015
"""m; corners are in whole mm, each away from the axes."""


def beyond(points: Array, corners: Array) -> float:
    """How far points (n, 2) lie out of a counter-clockwise outline (k, 2), m."""
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return float((points @ normals.T - (normals * corners).sum(axis=1)).max())


@st.composite
def bases(draw: st.DrawFn) -> Array:
    """Points (n, 2) of a base: ellipses of many corners, or rounded boxes, anywhere, turned."""
    random = np.random.default_rng(draw(st.integers(0, 10_000)))
    count = draw(st.integers(8, 300))
    size = random.uniform(0.1, 0.6, 2)
    around = np.linspace(0, 2 * np.pi, count, endpoint=False) + random.uniform(0, 1)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    power = draw(st.sampled_from([1.0, 0.5, 0.1]))  # 1 is round, less is nearer to a box
    points = np.sign(circle) * np.abs(circle) ** power * size
    c, s = math.cos(size[0] * 9), math.sin(size[0] * 9)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + random.uniform(-0.3, 0.3, 2))


@given(bases())
@settings(max_examples=100)
def test_an_outline_encloses_its_base_closely_with_few_corners(base: Array) -> None:
    corners = outline(np.column_stack([base, np.zeros(len(base))]))
    assert corners is not None
    assert len(corners) <= CORNERS
    assert beyond(base, corners) <= WHOLE
    long = float(np.linalg.norm(np.ptp(base, axis=0)))
    assert beyond(corners, base[ConvexHull(base).vertices]) < 0.04 * long


@pytest.mark.parametrize(
    "points",
    [np.zeros((0, 3)), np.zeros((2, 3)), np.zeros((9, 3)), np.outer(np.arange(9), (1, 1, 0))],
)
def test_what_has_no_area_has_no_outline(points: Array) -> None:
    assert outline(points) is None


WHEEL_TURN = "1.5707963 0 0"


def wheel(name: str, x: float, y: float, radius: float, yaw: float = 0.0) -> list[str]:
    shape = f'<cylinder radius="{radius}" length="0.04"/>'
    return [
        link(name, shape, rpy=WHEEL_TURN),
        joint(
            f"{name}_joint", "base_link", name, f"{x} {y} {radius}", "0 1 0", "continuous",
            rpy=f"0 0 {yaw}",
        ),
    ]  # fmt: skip


@given(
    st.lists(
        st.tuples(
            st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(0.04, 0.2), st.floats(-3, 3)
        ),
        min_size=1,
        max_size=4,
    ),
    st.floats(0.2, 0.8),
)
@settings(max_examples=25)
def test_a_footprint_contains_every_wheel(
    wheels: list[tuple[float, float, float, float]], length: float
) -> None:
    radius = max(r for _, _, r, _ in wheels)
    made: list[str] = []
    for i, (x, y, _, yaw) in enumerate(wheels):
        made += wheel(f"w{i}", x, y, radius, yaw)
    body = body_of(link("base_link", box(length, 0.3, 0.1), f"0 0 {radius + 0.06}", 20), *made)
    stand = find_stand(body)
    assert set(stand.wheels) == {f"w{i}" for i in range(len(wheels))} == set(stand.grounded)
    assert stand.footprint is not None
    for name in (*stand.wheels, *stand.fixed):
        low = body.points([name], {})
        assert beyond(low[low[:, 2] < 0.25][:, :2], stand.footprint) < WHOLE, name
    assert -0.03 * radius < stand.floor <= 0.0  # hulls enclose what is round
    assert stand.mass == pytest.approx(20 + len(wheels))
    assert stand.front == stand.footprint[:, 0].max()


BASE = link("base_link", box(0.5, 0.4, 0.2), "0 0 0.2", 30)


@pytest.mark.parametrize(
    ("why", "part", "rolls"),
    [
        ("it rolls", wheel("w", 0.2, 0.0, 0.1), True),
        ("it turns about the vertical", [
            link("w", '<cylinder radius="0.1" length="0.2"/>'),
            joint("j", "base_link", "w", "0 0 0.1", "0 0 1", "continuous")], False),
        ("its joint has an end", [
            link("w", '<cylinder radius="0.1" length="0.04"/>', rpy=WHEEL_TURN),
            joint("j", "base_link", "w", "0 0 0.1", "0 1 0", "revolute")], False),
        ("it hangs above the floor", [
            *wheel("other", 0.2, 0.0, 0.1),
            link("w", '<cylinder radius="0.05" length="0.04"/>', rpy=WHEEL_TURN),
            joint("j", "base_link", "w", "-0.2 0 0.1", "0 1 0", "continuous")], False),
        ("it is as large as a robot", wheel("w", 0.2, 0.0, 0.3), False),
        ("it has no shape", [
            link("w"), joint("j", "base_link", "w", "0 0 0", "0 1 0", "continuous")], False),
    ],
)  # fmt: skip
def test_what_rolls_is_a_wheel(why: str, part: list[str], rolls: bool) -> None:
    assert ("w" in find_stand(body_of(BASE, *part)).wheels) == rolls, why


def test_a_caster_is_a_wheel_with_its_fork() -> None:
    fork = [
        link("fork", box(0.03, 0.06, 0.05), "0 0 -0.02"),
        joint("swivel", "base_link", "fork", "-0.2 0 0.1", "0 0 1", "continuous"),
        link("roll", '<cylinder radius="0.04" length="0.02"/>', rpy=WHEEL_TURN),
        joint("axle", "fork", "roll", "-0.03 0 -0.06", "0 1 0", "continuous"),
    ]
    assert find_stand(body_of(BASE, *fork)).wheels == ("fork", "roll")


VIRTUAL = [
    link("world", mass=0),
    link("x", mass=0),
    link("y", mass=0),
    joint("slide_x", "world", "x", axis="1 0 0", kind="prismatic"),
    joint("slide_y", "x", "y", axis="0 1 0", kind="prismatic"),
]


def test_joints_that_place_the_base_in_the_world_are_virtual() -> None:
    turn = joint("turn", "y", "base_link", kind="continuous")
    skeleton = body_of(*VIRTUAL, turn, BASE).skeleton
    base = find_base(skeleton)
    assert base.frame == "base_link"
    assert base.virtual == ("slide_x", "slide_y", "turn")
    assert planar(skeleton, base.virtual) == base.virtual
    assert planar(skeleton, ("slide_y", "slide_x", "turn")) is None
    assert planar(skeleton, ("slide_x", "slide_y")) is None


def test_a_joint_that_stands_off_carries_an_arm_and_no_base() -> None:
    """A rail in front of the world is part of the robot: its joint is not virtual."""
    off = joint("turn", "y", "base_link", "0 0 0.4", kind="continuous")
    base = find_base(body_of(*VIRTUAL, off, BASE).skeleton)
    assert "turn" not in base.virtual


@pytest.mark.parametrize(
    ("names", "frame"),
    [
        (("base_footprint", "base_link"), "base_footprint"),
        (("world", "base"), "base"),
        (("odom", "platform"), "platform"),
        (("chassis", "body"), "chassis"),
    ],
)
def test_bases_go_by_their_usual_names(names: tuple[str, str], frame: str) -> None:
    one, other = names
    shaped = link(other, box(0.5, 0.4, 0.2), "0 0 0.1")
    fixed = joint("fixed", one, other, kind="fixed")
    assert find_base(body_of(link(one, mass=0), shaped, fixed).skeleton).frame == frame
