"""Skills look with the first camera: the one that sees tables ahead best comes first."""

from __future__ import annotations

import pytest
from momantu_skills.robot_setup.find.cameras import best_first
from momantu_skills.robot_setup.find.fingers import find_hands
from momantu_skills.robot_setup.find.sensors import FoundSensor

from tests.skills.robot_setup.conftest import body_of, box, joint, link, rod

AHEAD = "-1.5708 0 -1.5708"
"""Turn of an optical frame that looks ahead, rad."""
LEFT = "-1.5708 0 0"


def fixed(name: str, height: float, turn: str = AHEAD, on: str = "base_link") -> str:
    place = joint(f"{name}_joint", on, name, f"0 0 {height}", kind="fixed", rpy=turn)
    return link(name, mass=0) + place


def order(*elements: str, cameras: tuple[str, ...], depth: str = "") -> list[str]:
    """The cameras in their order; those named are optical frames, one may be written as depth's."""
    body = body_of(link("base_link", box(0.5, 0.4, 0.2), "0 0 0.1", 30), *elements)
    sensors = [
        FoundSensor("camera", name, written=True, optical=True, depth=name == depth)
        for name in cameras
    ]
    laser = FoundSensor("laser", "base_link", written=True)
    found = best_first(body, [laser, *sensors], find_hands(body))
    assert found[0] is laser
    return [sensor.link for sensor in found[1:]]


@pytest.mark.parametrize("depth", ["head_rgbd_sensor_camera", "kinect_camera", "astra_color"])
def test_a_camera_with_depth_comes_before_the_eyes_of_a_stereo_camera(depth: str) -> None:
    eyes = ("head_l_stereo_camera", "head_r_stereo_camera", "wide_camera")
    links = [fixed(name, 1.2) for name in (*eyes, depth)]
    assert order(*links, cameras=(*eyes, depth)) == [depth, *eyes]
    assert order(*links[:3], cameras=eyes, depth=eyes[1])[0] == eyes[1]


@pytest.mark.parametrize(
    ("height", "turn", "good"),
    [(1.0, AHEAD, True), (0.55, AHEAD, True), (0.3, AHEAD, False), (1.0, LEFT, False)],
)
def test_a_fixed_camera_must_see_tables_ahead(height: float, turn: str, good: bool) -> None:
    cameras = ("first_rgbd", "second")
    found = order(fixed("first_rgbd", height, turn), fixed("second", 1.1), cameras=cameras)
    assert found == (list(cameras) if good else ["second", "first_rgbd"])


def test_a_camera_on_a_head_comes_before_a_fixed_one() -> None:
    head = [
        link("pan_link", box(0.1, 0.1, 0.1)),
        joint("pan", "base_link", "pan_link", "0 0 1"),
        fixed("head_rgbd", 0.1, on="pan_link"),
        fixed("torso_rgbd", 0.8),
        fixed("base_rgbd", 0.2),
    ]
    given = ("base_rgbd", "torso_rgbd", "head_rgbd")
    assert order(*head, cameras=given) == ["head_rgbd", "torso_rgbd", "base_rgbd"]


def test_a_camera_on_a_hand_comes_after_one_on_a_head() -> None:
    slide = 'lower="0" upper="0.04" velocity="0.05" effort="20"'
    links = [
        link("a", rod(0.2), "0.1 0 0"),
        link("palm", box(0.04, 0.1, 0.04), "0.03 0 0"),
        joint("pan", "base_link", "a", "0.2 0 0.5"),
        joint("lift", "a", "palm", "0.2 0 0", "0 1 0"),
        link("lf", box(0.05, 0.01, 0.02), "0.08 0.005 0", 0.05),
        link("rf", box(0.05, 0.01, 0.02), "0.08 -0.005 0", 0.05),
        joint("ls", "palm", "lf", "0 0 0", "0 1 0", "prismatic", slide),
        joint("rs", "palm", "rf", "0 0 0", "0 -1 0", "prismatic", slide),
        fixed("hand_rgbd", 0.05, on="palm"),
        link("head", box(0.1, 0.1, 0.1)),
        joint("nod", "base_link", "head", "0 0 1", "0 1 0"),
        fixed("head_rgbd", 0.1, on="head"),
    ]
    assert order(*links, cameras=("hand_rgbd", "head_rgbd")) == ["head_rgbd", "hand_rgbd"]
    assert order(*links, cameras=("hand_rgbd",)) == ["hand_rgbd"]
