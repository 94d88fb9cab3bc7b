"""record_view: a line that `calibrate robot` reads, or why there is none."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.calibration.robot.rows import read_rows
from momantu_skills.calibration.robot.start import poses_seen
from momantu_skills.record_view import RecordView

from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill
from momantu_bt.testing.painting import Solid
from tests.skills.test_find_apriltag import EDGE, TABLE, card

Record = Callable[..., SkillResult]


@pytest.fixture
def record(onlooker: Callable[..., ScriptedRobot], tmp_path: Path) -> Record:
    """`record(solids)` runs it before a table with those things on it."""

    def run(things: list[Solid], file: Path = tmp_path / "views.jsonl", **joints: Any) -> Any:
        robot = onlooker([TABLE, *things], seed=5)
        robot.joints.update({"lift": 0.3, "tilt": 0.7}, **joints)
        return run_skill(RecordView, robot=robot, inputs={"file": str(file), "edge": EDGE})

    return run


def test_the_line_has_the_tag_where_it_is(record: Record, tmp_path: Path) -> None:
    result = record([card(3, 1.0, 0.1)])
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["seen"] == 1
    (row,) = read_rows(tmp_path / "views.jsonl")
    (tag,) = row.tags
    assert (tag.tag_id, tag.edge) == (3, EDGE)
    assert row.joints["lift"] == pytest.approx(0.3, abs=0.01)
    assert row.intrinsics is not None
    unit = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    robot = result.robot
    camera = robot.description.camera()[1].frame
    base_from_camera = robot.description.kinematics().base_from_frame(camera, row.joints).matrix
    poses = [base_from_camera @ p for p in poses_seen(unit * EDGE, tag.corners, row.intrinsics)]
    off = [np.linalg.norm(pose[:3, 3] - [1.0, 0.1, 0.521]) for pose in poses]
    best = poses[int(np.argmin(off))]
    assert min(off) < 0.02
    assert math.atan2(best[1, 0], best[0, 0]) == pytest.approx(0.4, abs=0.05)


def test_without_a_tag_it_is_TAG_NOT_SEEN(record: Record, tmp_path: Path) -> None:
    assert record([]).code == "TAG_NOT_SEEN"
    assert not (tmp_path / "views.jsonl").exists()


def test_views_of_another_run_are_kept(record: Record, tmp_path: Path) -> None:
    file = tmp_path / "views.jsonl"
    file.write_text('{"stamp": 1000.0}\n', encoding="utf-8")
    result = record([card(3, 1.0, 0.1)])
    assert result.code == "VIEW_NOT_WRITTEN"
    assert "it is another run's" in result.explain()
    file.write_text("notes\n", encoding="utf-8")
    assert "is no file of views" in record([card(3, 1.0, 0.1)]).explain()
    assert file.read_text(encoding="utf-8") == "notes\n"
    assert record([card(3, 1.0, 0.1)], file=tmp_path).code == "VIEW_NOT_WRITTEN"


def test_a_robot_that_does_not_come_to_rest_is_STILL_MOVING(
    record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("momantu_skills.perception.camera.standing.STILL", -1.0)
    assert record([card(3, 1.0, 0.1)]).code == "STILL_MOVING"
