"""find_apriltag: where the asked tag lies, how surely, or that it is not there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from momantu_skills.find_apriltag import FindAprilTag

from momantu_bt.claim import TagAt, TagOn
from momantu_bt.geometry import Pose2D, Transform, quaternion_from_rpy
from momantu_bt.messages import CameraImage
from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill, scripted_site
from momantu_bt.testing.painting import Block, Card, Round, Solid
from momantu_bt.world import Surface

TOP, EDGE = 0.52, 0.15
TABLE = Block((0.6, 1.2, 0.03), (1.05, 0.0, TOP - 0.015))
SITE = scripted_site(
    surfaces={"table": Surface(Pose2D(1.0, 0.0, 0.0), (0.6, 1.2), 0.5, (math.pi,))}
)


def card(tag_id: int, x: float, y: float, yaw: float = 0.4, edge: float = EDGE) -> Card:
    """A tag with a white margin. OpenCV draws the family's tags turned by half a turn."""
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    bits = cv2.aruco.generateImageMarker(family, tag_id, 8)[::-1, ::-1]
    pixels = np.ones((10, 10), dtype=np.uint8)
    pixels[1:-1, 1:-1] = bits > 127
    pose = Transform((x, y, TOP + 0.001), quaternion_from_rpy(0.0, 0.0, yaw))
    return Card(pose, edge * 10 / 8, pixels)


@pytest.fixture
def find(
    onlooker: Callable[..., ScriptedRobot], seen_scene: Callable[..., Any]
) -> Callable[..., SkillResult]:
    """`find(solids, …)` runs the skill for tag 1 before the table with those things on it."""

    def run(things: list[Solid], **inputs: Any) -> SkillResult:
        robot = onlooker([TABLE, *things], seed=5)
        robot.joints["lift"] = 0.3
        return run_skill(
            FindAprilTag,
            robot=robot,
            inputs={"tag_id": 1, "edge": EDGE, "on": "table", **inputs},
            services={"planning_scene": seen_scene(), "localization": None},
            site=SITE,
            map_from_odom=Transform(),
        )

    return run


Find = Callable[..., SkillResult]


class Dim:
    """A camera in little light: the picture of another one, darker and with noise."""

    def __init__(self, painted: Callable[[ScriptedRobot], CameraImage], share: float, noise: float):
        self._painted, self._share, self._noise = painted, share, noise

    def __call__(self, robot: ScriptedRobot) -> CameraImage:
        image = self._painted(robot)
        random = np.random.default_rng(round(1000 * robot.now()))
        grain = self._noise * random.standard_normal(image.color.shape)
        color = np.clip(np.rint(self._share * image.color + grain), 0, 255).astype(np.uint8)
        return replace(image, color=color)


@pytest.fixture
def find_dim(
    onlooker: Callable[..., ScriptedRobot], seen_scene: Callable[..., Any]
) -> Callable[..., SkillResult]:
    """`find_dim(things, share, noise)`: as `find`, in little light."""

    def run(things: list[Solid], share: float, noise: float) -> SkillResult:
        robot = onlooker([TABLE, *things], seed=5)
        robot.joints["lift"] = 0.3
        robot.readings["camera"] = Dim(robot.readings["camera"], share, noise)
        return run_skill(
            FindAprilTag,
            robot=robot,
            inputs={"tag_id": 1, "edge": EDGE, "on": "table"},
            services={"planning_scene": seen_scene(), "localization": None},
            site=SITE,
            map_from_odom=Transform(),
        )

    return run


@pytest.mark.parametrize(("share", "noise"), [(0.12, 0.0), (0.2, 8.0)])
def test_a_tag_in_little_light_is_measured_as_well(
    find_dim: Find, share: float, noise: float
) -> None:
    result = find_dim([card(1, 0.9, 0.0)], share, noise)
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["tag_pose"].position == pytest.approx((0.9, 0.0, TOP), abs=0.006)


def test_where_it_is_too_dark_the_failure_says_so_and_what_helps(find_dim: Find) -> None:
    result = find_dim([card(1, 0.9, 0.0)], 0.01, 6.0)
    assert result.code == "TAG_NOT_SEEN"
    assert "it was too dark (mean brightness " in result.explain()
    assert "longer exposure or more gain" in result.explain()
    assert result.failure is not None
    assert result.failure.data["dark_pictures"] > 0


def test_a_tag_that_is_missing_in_good_light_is_not_called_dark(find: Find) -> None:
    result = find([])
    assert result.code == "TAG_NOT_SEEN"
    assert "too dark" not in result.explain()


@pytest.mark.parametrize(("x", "y", "yaw"), [(0.9, 0.0, 0.0), (1.15, 0.3, 2.0), (1.0, -0.4, -1.2)])
def test_the_tag_is_measured_within_its_uncertainty(
    find: Find, x: float, y: float, yaw: float
) -> None:
    result = find([card(1, x, y, yaw)])
    assert result.status == "SUCCESS", result.explain()
    pose, sigma = result.outputs["tag_pose"], result.outputs["tag_sigma"]
    error = float(np.linalg.norm(pose.position - (x, y, TOP + 0.001)))
    assert error < 0.004
    assert 0.0001 < sigma < 0.003
    true = Transform((x, y, TOP), quaternion_from_rpy(0.0, 0.0, yaw))
    assert pose.transform.angle_to(true) < math.radians(1.5)
    assert pose.frame == "odom"


def test_another_tag_is_not_the_asked_one_but_is_told(find: Find) -> None:
    result = find([card(7, 0.9, 0.0)])
    assert result.code == "TAG_NOT_SEEN"
    assert result.failure is not None
    assert list(result.failure.data["other_tags"]) == [7]


def test_the_asked_tag_is_taken_from_several(find: Find) -> None:
    result = find([card(7, 0.9, 0.0), card(1, 0.9, -0.35)])
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["tag_pose"].position[1] == pytest.approx(-0.35, abs=0.005)


def test_a_tag_of_another_size_is_another_tag(find: Find) -> None:
    result = find([card(1, 0.9, 0.0, edge=0.10)])
    assert result.code == "TAG_NOT_SEEN"
    assert "its edge is not 0.15 m" in result.explain()


def test_a_covered_tag_is_not_seen(find: Find) -> None:
    result = find([card(1, 0.95, 0.0), Round((0.95, 0.0, TOP), 0.05, 0.09)])
    assert result.code == "TAG_NOT_SEEN"


def test_an_unknown_surface_is_told_with_those_there_are(find: Find) -> None:
    result = find([], on="shelf")
    assert result.code == "TAG_NOT_SEEN"
    assert "surfaces: table" in result.explain()


def test_without_a_surface_it_looks_around(find: Find) -> None:
    result = find([card(1, 0.95, 0.5)], on=None)
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["tag_pose"].position == pytest.approx((0.95, 0.5, TOP), abs=0.005)


def test_the_tag_is_claimed_to_lie_where_it_was_measured(find: Find) -> None:
    result = find([card(1, 0.9, 0.0, 0.7)])
    claim = result.claim()
    assert isinstance(claim, TagAt)
    assert (claim.tag_id, claim.odom_from_tag) == (1, result.outputs["tag_pose"].transform)
    true = Transform((0.9, 0.0, TOP + 0.001), quaternion_from_rpy(0.0, 0.0, 0.7))
    assert np.linalg.norm(claim.odom_from_tag.position - true.position) < claim.tolerance
    assert claim.odom_from_tag.angle_to(true) < claim.turn_tolerance


def test_a_tag_that_is_not_seen_would_be_a_false_alarm_on_that_surface(find: Find) -> None:
    assert find([card(7, 0.9, 0.0)]).claim() == TagOn(1, "table")
    assert find([card(7, 0.9, 0.0)], on=None).claim() is None
    assert find([], on="shelf").claim() is None
