"""record_picture: pictures of a board, and what they cover while they are collected."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.calibration.camera.board import Board
from momantu_skills.calibration.camera.collecting import read_index
from momantu_skills.calibration.camera.pictures import read_pictures
from momantu_skills.record_picture import RecordPicture

from momantu_bt.messages import CameraImage
from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill, small_robot
from tests.skills.scenery.boards import CHESSBOARD, MATRIX, picture, places

GRID = Board("aprilgrid", 5, 4, 0.03, gap=0.0075)


def record(folder: Path, shown: np.ndarray, board: Board = CHESSBOARD, **more: Any) -> SkillResult:
    robot = ScriptedRobot(small_robot())
    name, sensor = robot.description.camera()

    def read(now: ScriptedRobot) -> CameraImage:
        color = np.repeat(shown[..., None], 3, axis=2).astype(np.uint8)
        depth = np.zeros(shown.shape, dtype=np.float32)
        return CameraImage(now.now(), sensor.frame, color, depth, MATRIX)

    robot.readings[name] = read
    inputs = {"folder": str(folder), "board": str(board), "square": board.square}
    return run_skill(RecordPicture, robot=robot, inputs={**inputs, **more})


def test_pictures_are_kept_until_nothing_is_missing(tmp_path: Path) -> None:
    folder, covered = tmp_path / "pictures", 0
    for number, (turn, shift) in enumerate(places(1, 6), 1):
        result = record(folder, picture(CHESSBOARD, turn, shift))
        assert result.status == "SUCCESS", result.explain()
        assert result.outputs["pictures"] == number
        assert result.outputs["covered"] >= covered
        covered = result.outputs["covered"]
    assert any("cover" in line for line in result.logs)
    assert any(set(line.strip()) <= {"#", "."} for line in result.logs)
    assert len(read_index(folder)) == 6
    assert len(read_pictures(folder, CHESSBOARD).names) == 6


def test_what_is_missing_is_said(tmp_path: Path) -> None:
    flat = picture(CHESSBOARD, np.zeros(3), np.array([-0.1, -0.06, 0.5]))
    result = record(tmp_path, flat)
    assert result.outputs["enough"] is False
    assert "missing: the board at" in result.logs[-1]
    assert "the board turned right, left, down, up by 20 degrees" in result.logs[-1]


def test_an_aprilgrid_is_collected_too(tmp_path: Path) -> None:
    turn, shift = places(1, 1)[0]
    shown = picture(GRID, turn, shift)
    result = record(tmp_path, shown, GRID, gap=GRID.gap)
    assert result.status == "SUCCESS", result.explain()


def test_each_failure_is_told(tmp_path: Path) -> None:
    nothing = np.full((480, 640), 128, dtype=np.uint8)
    assert record(tmp_path, nothing).code == "BOARD_NOT_SEEN"
    assert record(tmp_path, nothing, board=Board("checkers", 3, 3, 0.03)).code == "BAD_BOARD"
    turn, shift = places(1, 1)[0]
    shown = picture(CHESSBOARD, turn, shift)
    assert record(tmp_path, shown).status == "SUCCESS"
    other = record(tmp_path, shown, board=Board("chessboard", 8, 6, 0.025))
    assert other.code == "BAD_BOARD"
    assert "name another folder" in other.explain()
    file = tmp_path / "file"
    file.write_text("", encoding="utf-8")
    assert record(file / "below", shown).code == "PICTURE_NOT_WRITTEN"
    (tmp_path / "seen.jsonl").write_text("no JSON\n", encoding="utf-8")
    assert record(tmp_path, shown).code == "PICTURE_NOT_WRITTEN"


def test_a_robot_that_moves_is_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from momantu_skills.perception.camera import standing

    monkeypatch.setattr(standing, "_moves", lambda state: True)
    result = record(tmp_path, np.zeros((480, 640), dtype=np.uint8))
    assert result.code == "STILL_MOVING"
