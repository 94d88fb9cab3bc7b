"""detect_tags: every tag of a picture, with its pose and covariance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from momantu_skills.detect_tags import DetectTags

from momantu_bt.claim import TagAt
from momantu_bt.geometry import Transform
from momantu_bt.tags import TagBundle, single_tag
from momantu_bt.testing import SkillResult, run_skill, scripted_site, small_robot
from momantu_bt.testing.robot import ScriptedRobot
from tests.skills.scenery.tag_pictures import before, grid, picture

BOARD, MARK = grid(), single_tag(30, 0.08)
PLACES = (before(0.9, 0.3, 0.0, 0.0, (-0.15, 0.0)), before(0.9, 0.2, 1.0, 0.5, (0.2, 0.1)))


def seen_by(placed: Sequence[tuple[TagBundle, Transform]]) -> ScriptedRobot:
    robot = ScriptedRobot(small_robot())
    frame = robot.description.camera()[1].frame
    image = picture(placed)

    def read(now: ScriptedRobot) -> Any:
        return type(image)(now.now(), frame, image.color, image.depth, image.intrinsics)

    robot.readings["camera"] = read
    return robot


def detect(placed: Sequence[tuple[TagBundle, Transform]], **inputs: Any) -> SkillResult:
    known = {"board": BOARD, "mark": MARK}
    return run_skill(
        DetectTags, robot=seen_by(placed), inputs=inputs, site=scripted_site(tags=known)
    )


def test_all_that_the_site_knows_is_measured_with_its_covariance() -> None:
    result = detect([(BOARD, PLACES[0]), (MARK, PLACES[1])])
    assert result.status == "SUCCESS", result.explain()
    board, mark = result.outputs["tags"]
    assert (board.name, board.ids, board.family) == ("board", (0, 1, 2, 3, 4, 5), "tag36h11")
    assert (mark.name, mark.ids, mark.edges) == ("mark", (30,), (0.08,))
    assert result.outputs["ids"] == (0, 1, 2, 3, 4, 5, 30)
    apart = board.pose.transform.inverse() @ mark.pose.transform
    truth = PLACES[0].inverse() @ PLACES[1]
    assert np.linalg.norm(apart.position - truth.position) < 0.004
    for tag in (board, mark):
        covariance = np.reshape(tag.covariance, (6, 6))
        assert covariance == pytest.approx(covariance.T)
        assert (np.linalg.eigvalsh(covariance) > 0).all()
    claims = result.claim()
    assert isinstance(claims, tuple)
    (claim,) = claims
    assert isinstance(claim, TagAt)
    assert claim.tag_id == 30


def test_an_edge_gives_poses_to_tags_that_nobody_knows() -> None:
    loose = single_tag(40, 0.05)
    assert detect([(loose, PLACES[0])]).code == "TAG_NOT_SEEN"
    result = detect([(loose, PLACES[0])], edge=0.05)
    assert result.status == "SUCCESS", result.explain()
    (tag,) = result.outputs["tags"]
    assert (tag.name, tag.ids) == ("", (40,))


def test_without_a_pose_the_failure_says_why() -> None:
    nothing = detect([])
    assert nothing.code == "TAG_NOT_SEEN"
    assert "shows no tag" in nothing.explain()
    unknown = detect([(single_tag(40, 0.05), PLACES[0])])
    assert "shows the tags 40, but none has a pose" in unknown.explain()
    small = detect([(single_tag(30, 0.05), PLACES[0])])
    assert "mark: depth says that the edge is not 0.08 m" in small.explain()
