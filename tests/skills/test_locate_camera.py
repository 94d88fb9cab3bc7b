"""locate_camera: the camera's place in the map, from tags whose places the site knows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from momantu_skills.locate_camera import LocateCamera

from momantu_bt.claim import CameraAt
from momantu_bt.geometry import Transform, quaternion_from_rpy
from momantu_bt.tags import TagBundle, single_tag
from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill, scripted_site
from momantu_bt.testing.painting import Block, Card, Solid
from tests.skills.test_find_apriltag import EDGE, TABLE, TOP, card

BEHIND = Block((0.1, 4.0, 2.5), (2.5, 0.0, 1.25))
MAP_FROM_ODOM = Transform((3.0, -1.0, 0.0), quaternion_from_rpy(0.0, 0.0, 0.8))
Locate = Callable[..., SkillResult]


def known(
    tag_id: int, drawn: Card, edge: float = EDGE, aside: tuple[float, ...] = (0.0, 0.0, 0.0)
) -> TagBundle:
    """A tag where it is drawn, as the site tells it, `aside` of the truth."""
    place = MAP_FROM_ODOM @ drawn.odom_from_card @ Transform(aside)
    return replace(single_tag(tag_id, edge), map_from_bundle=place)


@pytest.fixture
def locate(onlooker: Callable[..., ScriptedRobot], seen_scene: Callable[..., Any]) -> Locate:
    """`locate(things, tags, …)` runs the skill before the table with those things on it."""

    def run(things: list[Solid], tags: Mapping[str, TagBundle], **inputs: Any) -> SkillResult:
        robot = onlooker([TABLE, BEHIND, *things], seed=5)
        robot.joints["lift"] = 0.3
        return run_skill(
            LocateCamera,
            robot=robot,
            inputs=inputs,
            services={"planning_scene": seen_scene()},
            site=scripted_site(tags=tags),
            map_from_odom=MAP_FROM_ODOM,
        )

    return run


ONE, OTHER = card(1, 0.9, 0.1), card(2, 0.9, -0.2)


def test_the_camera_is_measured_within_what_it_claims(locate: Locate) -> None:
    result = locate([ONE, OTHER], {"one": known(1, ONE), "other": known(2, OTHER)})
    assert result.status == "SUCCESS", result.explain()
    pose = result.outputs["camera_pose"]
    assert pose.frame == "map"
    claim = result.claim()
    assert isinstance(claim, CameraAt)
    assert claim.map_from_camera == pose.transform
    covariance = np.reshape(result.outputs["camera_covariance"], (6, 6))
    assert (np.linalg.eigvalsh(covariance) > 0).all()
    assert np.sqrt(np.trace(covariance[:3, :3])) < 0.02
    # where the tag is seen, told from the measured camera, is where the tag is
    assert 0.3 < np.linalg.norm(pose.position - known(1, ONE).map_from_bundle.position) < 1.6  # type: ignore[union-attr]


def test_the_asked_tag_alone_counts(locate: Locate) -> None:
    tags = {"one": known(1, ONE), "other": known(2, OTHER, aside=(0.5, 0.0, 0.0))}
    result = locate([ONE, OTHER], tags, tag="one")
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["seen"] == (1,)


def test_without_a_tag_it_says_which_are_there(locate: Locate) -> None:
    result = locate([ONE], {"other": known(2, OTHER)})
    assert result.code == "TAG_NOT_SEEN"
    assert "other tags there: 1" in result.explain()


def test_a_tag_without_a_place_is_refused(locate: Locate) -> None:
    assert locate([ONE], {"one": single_tag(1, EDGE)}).code == "TAG_PLACE_UNKNOWN"
    result = locate([ONE], {}, tag="one")
    assert result.code == "TAG_PLACE_UNKNOWN"
    assert "site.tags" in result.explain()


def test_tags_that_contradict_each_other_are_unusable(locate: Locate) -> None:
    tags = {"one": known(1, ONE), "other": known(2, OTHER, aside=(0.4, 0.3, 0.0))}
    result = locate([ONE, OTHER], tags)
    assert result.code == "TAG_UNUSABLE"
    assert "do they hang where the site says" in result.explain()


def test_a_wrong_size_is_unusable(locate: Locate) -> None:
    result = locate([ONE], {"one": known(1, ONE, edge=1.4 * EDGE)})
    assert result.code == "TAG_UNUSABLE"
    assert "depth denies the edges" in result.explain()


def test_the_tag_lies_where_the_scene_says() -> None:
    assert ONE.odom_from_card.position[2] == pytest.approx(TOP + 0.001)
