"""`calibrate robot`: bent robots become straight, what cannot be told is said, each mistake."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.robot.estimate import Calibrated, Settings, calibrate
from momantu_skills.calibration.robot.model import _composed
from momantu_skills.calibration.robot.parameters import columns, mounted
from momantu_skills.calibration.robot.rows import read_rows
from momantu_skills.calibration.robot.telling import untold
from momantu_skills.manipulation.model.batched import BatchedChain

from momantu_bt.cli import main
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import WheelCorrection
from momantu_bt.robots.plugins import load_robot
from momantu_bt.wheels import Wheels
from tests.skills.scenery.bent import HAND_TAG, Bent, Measuring, write

FETCH = load_robot("fetch")
JACKAL = load_robot("kinova_jackal")
TURN = (0.02, 0.028, 0.0)
"""2 degrees."""


def found_of(measuring: Measuring, path: Path, views: int = 30, **settings: object) -> Calibrated:
    rows = read_rows(write(path / "views.jsonl", measuring.rows(views)))
    return calibrate(rows, measuring.robot, Settings(**settings))  # type: ignore[arg-type]


def tip_errors(measuring: Measuring, found: Calibrated | None) -> Array:
    """How far the hand is from where the camera's picture should show it, m, in new postures."""
    positions = measuring.positions(40)
    hand = columns(measuring.hand.names, measuring.joints)
    camera = columns(measuring.camera.names, measuring.joints)
    true = measuring.true(positions)
    there = np.linalg.inv(measuring.base_from_camera(positions)) @ measuring.hand.matrices(
        true[:, hand]
    )
    believed, mount = positions.copy(), np.eye(4)
    if found is not None:
        told = found.solution.state.told
        at = columns(found.parameters.joints, measuring.joints)
        believed[:, at] += told[: len(at)]
        mount = mounted(told[found.parameters.mount]).matrix
    base_from_camera = measuring.camera.matrices(believed[:, camera]) @ mount
    here = np.linalg.inv(base_from_camera) @ measuring.hand.matrices(believed[:, hand])
    return np.linalg.norm(here[:, :3, 3] - there[:, :3, 3], axis=1)


@pytest.mark.parametrize("robot", [FETCH, JACKAL], ids=lambda robot: robot.name)
def test_batched_kinematics_is_that_of_the_description(robot: object) -> None:
    for frame in (robot.camera()[1].frame, robot.hand.frame):  # type: ignore[attr-defined]
        chain = BatchedChain(robot, frame)  # type: ignore[arg-type]
        positions = np.random.default_rng(0).uniform(-1, 1, (5, len(chain.names)))
        tree = robot.kinematics()  # type: ignore[attr-defined]
        for row, pose in zip(positions, chain.matrices(positions), strict=True):
            exact = tree.base_from_frame(frame, dict(zip(chain.names, row, strict=True)))
            assert pose == pytest.approx(exact.matrix, abs=1e-6)


@pytest.mark.parametrize(
    "bent",
    [
        Bent(zeros={"elbow_flex_joint": 0.03}),
        Bent(zeros={"shoulder_pan_joint": -0.03}),
        Bent(turn=TURN),
        Bent(zeros={"upperarm_roll_joint": 0.03}, turn=TURN, wheels=(1.02, 1.0)),
    ],
    ids=["elbow", "shoulder", "camera", "all"],
)
def test_the_hand_is_where_the_camera_sees_it_after_calibration(bent: Bent, tmp_path: Path) -> None:
    measuring = Measuring(FETCH, bent, seed=1)
    found = found_of(measuring, tmp_path)
    before, after = tip_errors(measuring, None), tip_errors(measuring, found)
    assert np.median(after) < 0.05 * np.median(before)
    assert after.max() < 0.002
    assert np.median(found.held_back.after) < 0.1 * np.median(found.held_back.before)
    assert found.held_back.hand
    assert list(found.in_hand) == [tag == HAND_TAG for tag in found.views.tag_ids]


def test_a_camera_on_the_arm_calibrates_the_arm_that_carries_it(tmp_path: Path) -> None:
    bent = Bent(zeros={"arm_joint_3": 0.03}, turn=TURN, track=0.37559)
    found = found_of(Measuring(JACKAL, bent, seed=1), tmp_path)
    at = found.parameters.joints.index("arm_joint_3")
    assert found.solution.state.told[at] == pytest.approx(0.03, abs=0.001)
    assert np.median(found.held_back.after) < 0.1 * np.median(found.held_back.before)


def test_a_wheel_that_is_too_large_and_another_focal_length_are_found(tmp_path: Path) -> None:
    bent = Bent(wheels=(1.02, 1.0), lens=1.02)
    found = found_of(Measuring(FETCH, bent, seed=2, stands=24), tmp_path, views=48)
    told, parameters = found.solution.state.told, found.parameters
    spread = np.sqrt(np.diag(found.solution.covariance))
    assert np.expm1(told[parameters.lens]) == pytest.approx(0.02, abs=0.002)
    radius, _, larger = told[parameters.wheels]
    assert larger == pytest.approx(-0.02, abs=0.006)
    assert abs(radius - 0.01) < 3 * spread[parameters.wheels][0] < 0.03


def test_deviations_are_those_of_the_errors(tmp_path: Path) -> None:
    ratios = []
    for seed in range(4):
        found = found_of(Measuring(FETCH, Bent(), seed=seed, stands=1), tmp_path)
        spread = np.sqrt(np.diag(found.solution.covariance))
        told = spread < 0.2 * found.parameters.usual
        ratios += list((found.solution.state.told / spread)[told & found.free])
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.8


def test_wrong_sightings_do_not_count(tmp_path: Path) -> None:
    bent = Bent(zeros={"elbow_flex_joint": 0.03})
    measuring = Measuring(FETCH, bent, seed=3)
    rows = measuring.rows(40)
    wrong = [row for row in rows if row.get("tags")][::5]
    for row in wrong:
        for tag in row["tags"]:  # type: ignore[attr-defined]
            tag["corners"] = np.add(tag["corners"], (60, -35)).tolist()
    found = calibrate(read_rows(write(tmp_path / "v.jsonl", rows)), FETCH, Settings())
    assert tip_errors(measuring, found).max() < 0.004
    lines = {rows.index(row) + 1 for row in wrong}
    assert set(found.views.lines[~found.solution.used]) == lines


def test_what_cannot_be_told_apart_is_said(tmp_path: Path) -> None:
    found = found_of(Measuring(FETCH, Bent(), seed=1), tmp_path)
    # Lifting the torso lifts camera and arm; what turns a tag of unknown pose last is unknown.
    assert ("zero of torso_lift_joint",) in found.untold
    assert ("zero of wrist_roll_joint",) in found.untold
    assert ("zero of head_tilt_joint", "camera's pitch") in found.untold
    assert not any("zero of elbow_flex_joint" in group for group in found.untold)


def test_combinations_are_named_by_their_parameters() -> None:
    names = ("a", "b", "c", "d")
    tells = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])  # a + b, and c
    assert untold(1e4 * tells.T @ tells, np.ones(4), names) == [("d",), ("a", "b")]


def test_a_calibration_is_written_into_a_robot_file_and_is_believed(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    assert FETCH.source is not None
    file.write_text(FETCH.source.read_text(encoding="utf-8"), encoding="utf-8")
    measuring = Measuring(FETCH, Bent(zeros={"elbow_flex_joint": 0.03}, turn=TURN), seed=4)
    views = write(tmp_path / "views.jsonl", measuring.rows(30))
    out = tmp_path / "found.json"
    command = ["calibrate", "robot", str(views), "--robot", str(file)]
    assert main([*command, "--write", str(file), "--json", str(out)]) == 0
    data = json.loads(out.read_text(encoding="utf-8"))
    assert data["joint_zeros"]["elbow_flex_joint"] == pytest.approx(0.03, abs=0.002)
    calibrated = load_robot(str(file))
    assert calibrated.simulation is not None
    assert calibrated.simulation.urdf == FETCH.urdf  # a simulator builds it as before
    again = calibrate(read_rows(views), calibrated, Settings())
    assert np.median(again.held_back.before) < 0.001
    assert main([*command, "--write", str(file)]) == 0
    text = file.read_text(encoding="utf-8")
    assert text.count("\ncalibration:") == 1
    assert "# Rubber pads" in text


def test_wheels_are_written_and_those_of_a_base_that_stood_are_kept(tmp_path: Path) -> None:
    file, bent = tmp_path / "robot.yaml", Bent(wheels=(1.02, 1.0))
    assert FETCH.source is not None
    file.write_text(FETCH.source.read_text(encoding="utf-8"), encoding="utf-8")
    for stands in (24, 1):
        measuring = Measuring(FETCH, bent, seed=2, stands=stands)
        views = write(tmp_path / "views.jsonl", measuring.rows(48))
        command = ["calibrate", "robot", str(views), "--robot", str(file)]
        assert main([*command, "--write", str(file)]) == 0
        wheels = load_robot(str(file)).wheels
        assert wheels is not None
        assert wheels.between == pytest.approx(bent.track, abs=1e-3)
        assert wheels.left_to_right == pytest.approx(-0.02, abs=0.006)
        assert wheels.radius == pytest.approx(0.01, abs=0.02)


def test_the_model_of_wheels_is_that_of_the_corrected_base() -> None:
    random = np.random.default_rng(0)
    for _ in range(20):
        radius, track, larger = random.uniform(-0.05, 0.05, 3)
        told = random.uniform(-0.3, 0.3, 3)
        correction = WheelCorrection(radius=radius, track=track, left_to_right=larger, between=0.4)
        step = Wheels.of(correction).true_step(Pose2D(*told))
        wheels = torch.tensor([[radius, track, larger]])
        composed = _composed(torch.tensor(told[None, None]), wheels, 0.4)[0]
        assert composed.tolist() == pytest.approx([step.x, step.y, step.yaw], abs=1e-9)


ROW = {
    "stamp": 1.0,
    "intrinsics": [554, 554, 320, 240],
    "joints": {"a": 0.1},
    "odometry": [0, 0, 0],
    "tags": [{"id": 3, "edge": 0.06, "corners": [[0, 9], [9, 9], [9, 0], [0, 0]]}],
}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no views; a view is one line of JSON"),
        ("{", "line 1, column 2: this is no JSON"),
        ("[]", "expected an object with the keys stamp"),
        (json.dumps(ROW | {"tag": 1}), "there is no key 'tag'; keys:"),
        (json.dumps(ROW | {"joints": {"a": float("nan")}}), "joint a: expected a finite number"),
        (json.dumps(ROW | {"intrinsics": None}), "intrinsics: expected"),
        (json.dumps(ROW | {"intrinsics": [0, 1, 2, 3]}), "fx and fy are above 0"),
        (json.dumps(ROW | {"odometry": [1, 2]}), "odometry: expected"),
        (json.dumps(ROW | {"tags": ROW["tags"] * 2}), "a tag is twice in one picture"),  # type: ignore[operator]
        (json.dumps(ROW | {"tags": [{"id": 3}]}), "exactly the keys id, edge and corners"),
        (
            json.dumps(ROW | {"tags": [{"id": 3, "edge": 60, "corners": []}]}),
            "the edge of tag 3 is 60 m; expected more than 0 and at most 2 m",
        ),
        (
            json.dumps(ROW | {"tags": [{"id": 3, "edge": 0.06, "corners": [[1, 2]]}]}),
            "tag 3: expected four corners",
        ),
        (json.dumps(ROW) + "\n" + json.dumps(ROW | {"stamp": 0}), "line 2: the stamp 0 is before"),
    ],
)
def test_a_wrong_line_is_named(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "views.jsonl"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(CalibrationError, match=message.replace("[", r"\[")):
        read_rows(file)


def test_views_that_tell_nothing_are_refused(tmp_path: Path) -> None:
    rows = [row for row in Measuring(FETCH, Bent(), 0, stands=1).rows(20) if row.get("tags")]
    few = read_rows(write(tmp_path / "few.jsonl", rows[:5]))
    with pytest.raises(CalibrationError, match="5 views .* 8 or more are needed"):
        calibrate(few, FETCH, Settings())
    alike = [rows[0] | {"stamp": float(i)} for i in range(20)]
    with pytest.raises(CalibrationError, match="all views are alike: no joint moves"):
        calibrate(read_rows(write(tmp_path / "alike.jsonl", alike)), FETCH, Settings())
    other = [row | {"joints": {"a": 0.0}} for row in rows]
    with pytest.raises(CalibrationError, match="position of torso_lift_joint is missing"):
        calibrate(read_rows(write(tmp_path / "other.jsonl", other)), FETCH, Settings())
    blind = [row | {"tags": []} for row in rows]
    with pytest.raises(CalibrationError, match="0 views of the camera head_camera"):
        calibrate(read_rows(write(tmp_path / "blind.jsonl", blind)), FETCH, Settings())
    views = read_rows(write(tmp_path / "views.jsonl", rows))
    with pytest.raises(CalibrationError, match="no two views show the tag 99; they show: "):
        calibrate(views, FETCH, Settings(held=(99,)))
    with pytest.raises(CalibrationError, match="no camera 'eye'; it has: head_camera"):
        calibrate(views, FETCH, Settings(camera="eye"))
    with pytest.raises(CalibrationError, match="there is no parameter 'focal' to keep"):
        calibrate(views, FETCH, Settings(keep=("focal",)))


def test_views_of_another_robot_fit_nothing(tmp_path: Path) -> None:
    rows = [row for row in Measuring(FETCH, Bent(), 0, stands=1).rows(14) if row.get("tags")]
    random = np.random.default_rng(0)
    for row in rows:
        row["joints"] = {k: float(random.uniform(-1, 1)) for k in row["joints"]}  # type: ignore[attr-defined]
    views = read_rows(write(tmp_path / "views.jsonl", rows))
    with pytest.raises(CalibrationError, match="no calibration of fetch explains the views"):
        calibrate(views, FETCH, Settings())


def test_a_calibration_is_not_written_into_another_robots_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    views = write(tmp_path / "views.jsonl", [])
    command = ["calibrate", "robot", str(views), "--robot", "fetch", "--write"]
    assert main([*command, str(tmp_path / "my_fetch" / "robot.yaml")]) == 2
    assert "make a copy first: cp -r" in capsys.readouterr().err
    assert JACKAL.source is not None
    (tmp_path / "robot.yaml").write_text(JACKAL.source.read_text("utf-8"), "utf-8")
    assert main([*command, str(tmp_path)]) == 2
    assert "describes kinova_jackal, and the views are of fetch" in capsys.readouterr().err
