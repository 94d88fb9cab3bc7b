"""view_tag: the arm chooses views of a board; with record_view they calibrate the camera."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.calibration import of_views, recorded
from momantu_skills.perception.tags.view_lines import hands_of
from momantu_skills.record_view import RecordView
from momantu_skills.view_tag import ViewTag
from momantu_worlds.scenes.catalogue.tags import picture_edge, tag_cells

from momantu_bt.cli import main
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Transform, quaternion_from_rpy
from momantu_bt.testing import eye_in_hand_robot, run_skill, scripted_site
from momantu_bt.testing.painting import Block, Card, Painter
from tests.skills.scenery.table import SceneOf, Tabletop
from tests.skills.scenery.tag_pictures import grid

BOARD = grid(3, 2, 0.05, 0.02)
PLACE = Transform((0.75, 0.0, 0.722), quaternion_from_rpy(0.0, 0.0, -math.pi / 2))
BENT = Transform((0.006, -0.004, 0.008), quaternion_from_rpy(0.02, -0.03, 0.015))
"""Where the camera is in the frame in which the robot's description has it."""


@pytest.fixture
def before_board(tabletop: type[Tabletop], scene_of: SceneOf, tmp_path: Path) -> Any:
    """`before_board()`: `run(skill, **inputs)` on a robot whose arm carries a bent camera."""
    robot = tabletop(can=None, pose="ready", description=eye_in_hand_robot())
    cards = [
        Card(
            PLACE @ plate.bundle_from_tag,
            picture_edge(plate.edge),
            tag_cells(plate.tag_id).astype(np.uint8),
        )
        for plate in BOARD.plates
    ]
    table = Block((0.8, 1.4, 0.72), (0.9, 0.0, 0.36))
    painter = Painter([table, *cards], mounting=BENT)
    robot.readings[robot.description.camera()[0]] = painter
    scene = scene_of(robot)
    scene.frames.set_map_from_odom(Transform(), 0.0)

    def run(skill: Any, **inputs: Any) -> Any:
        return run_skill(
            skill,
            robot=robot,
            inputs=inputs,
            services={"planning_scene": scene},
            site=scripted_site(surfaces={}, tags={"board": BOARD}),
            frames=scene.frames,
            on_tick=lambda session, world: scene.update(robot, robot.time),
        )

    return robot, run


def test_the_arm_collects_views_that_tell_where_its_camera_is(
    before_board: Any, tmp_path: Path
) -> None:
    robot, run = before_board
    file = str(tmp_path / "views.jsonl")
    at = Pose(PLACE, "odom", 0.0)
    turned = []
    for _ in range(9):
        moved = run(ViewTag, tag="board", at=at, file=file)
        assert moved.status == "SUCCESS", moved.explain()
        turned.append(moved.outputs["turned"])
        written = run(RecordView, file=file, target="board")
        assert written.status == "SUCCESS", written.explain()
    assert min(turned) > math.radians(8)
    assert len(hands_of(Path(file))) == 9

    hand, target = of_views.trajectories(Path(file))
    found = recorded.calibrate(hand, target, recorded.Settings())
    description = robot.description
    kinematics = description.kinematics()
    base_from_hand, base_from_camera = (
        kinematics.base_from_frame(frame, robot.joints)
        for frame in (description.hand.frame, description.camera()[1].frame)
    )
    truth = base_from_hand.inverse() @ base_from_camera @ BENT
    off = found.estimate.refined.mounting.eye.inverse() @ truth
    assert np.linalg.norm(off.position) < 0.004
    assert off.angle_to(Transform()) < math.radians(0.4)


def test_an_unknown_board_and_a_broken_file_are_told(before_board: Any, tmp_path: Path) -> None:
    _, run = before_board
    at = Pose(PLACE, "odom", 0.0)
    assert run(ViewTag, tag="bord", at=at).code == "TAG_UNKNOWN"
    file = tmp_path / "views.jsonl"
    file.write_text('{"base_from_hand": [1, 2]}\n', encoding="utf-8")
    result = run(ViewTag, tag="board", at=at, file=str(file))
    assert result.code == "VIEW_NOT_READ"
    assert "line 1" in result.explain()


def test_a_board_out_of_reach_has_no_view(before_board: Any) -> None:
    _, run = before_board
    away = Pose(Transform((4.0, 0.0, 0.7)), "odom", 0.0)
    result = run(ViewTag, tag="board", at=away)
    assert result.code == "NO_NEW_VIEW"
    assert "bring the robot nearer" in result.explain()


def test_a_camera_that_is_not_on_the_arm_is_refused(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(can=None)
    result = run_skill(
        ViewTag,
        robot=robot,
        inputs={"tag": "board", "at": Pose(PLACE, "odom", 0.0)},
        services={"planning_scene": scene_of(robot)},
        site=scripted_site(tags={"board": BOARD}),
        map_from_odom=Transform(),
    )
    assert result.code == "CAMERA_NOT_ON_ARM"


def test_the_verb_reads_views(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "views.jsonl"
    file.write_text(json.dumps({"stamp": 1.0, "joints": {}}) + "\n", encoding="utf-8")
    assert main(["calibrate", "hand-eye", "--views", str(file)]) == 2
    assert "no view with the poses of hand and target" in capsys.readouterr().err
    hand = tmp_path / "hand.csv"
    assert main(["calibrate", "hand-eye", "--views", str(file), "--base-from-hand", str(hand)]) == 2
    assert "--views has both poses" in capsys.readouterr().err
    view = {"stamp": 1.0, "base_from_hand": [0, 0, 0, 0, 0, 0, 2]}
    view["camera_from_target"] = [0, 0, 1, 0, 0, 0, 1]
    file.write_text(json.dumps(view) + "\n", encoding="utf-8")
    assert main(["calibrate", "hand-eye", "--views", str(file)]) == 2
    assert "line 1: the quaternion has the length 2" in capsys.readouterr().err


@pytest.mark.parametrize("code", ["NO_PLAN", "START_IN_COLLISION", "ARM_STUCK"])
def test_what_stops_the_arm_is_told(
    before_board: Any, monkeypatch: pytest.MonkeyPatch, code: str
) -> None:
    _, run = before_board

    def stopped(*given: Any) -> Any:
        raise Failure(code, "the arm does not get there")

    monkeypatch.setattr("momantu_skills.gaze.tag_views.plan_view", stopped)
    result = run(ViewTag, tag="board", at=Pose(PLACE, "odom", 0.0))
    assert result.code == code
