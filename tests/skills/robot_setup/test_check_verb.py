"""`robots check`: every finding by a robot file that is wrong in that one way."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.collision import CollisionWorld, body_pairs
from momantu_skills.robot_setup.check.robot import check_robot
from momantu_skills.robot_setup.check_verb import check
from momantu_skills.robot_setup.find.named import TIPS
from momantu_skills.robot_setup.find.proposal import Proposal, propose
from momantu_skills.robot_setup.write.summary import lines
from momantu_skills.robot_setup.write.writer import robot_file, without
from momantu_worlds.robots import fetch
from typer import Typer
from typer.testing import CliRunner

from momantu_bt.errors import MomantuError
from momantu_bt.findings import Finding
from momantu_bt.plugins import PluginError
from momantu_bt.robots import read_robot

app = Typer()
app.command()(check)

Wrong = Callable[..., list[Finding]]


@pytest.fixture
def wrong(rolling_proposal: Proposal, tmp_path: Path) -> Wrong:
    """What is found when a text of the rolling robot's file is replaced by another."""

    def changed(*changes: tuple[str, str]) -> list[Finding]:
        text = robot_file(rolling_proposal, tmp_path)
        for before, after in changes:
            assert before in text, before
            text = text.replace(before, after)
        (tmp_path / "robot.yaml").write_text(text)
        return [f for f in check_robot(read_robot(tmp_path)) if f.code != "no-force"]

    return changed


def only(findings: list[Finding], code: str) -> Finding:
    assert {finding.code for finding in findings} == {code}, findings
    return findings[0]


def test_a_proposed_robot_is_fine(wrong: Wrong) -> None:
    assert wrong() == []


def test_fetch_is_fine() -> None:
    assert check_robot(fetch()) == []


def test_a_torso_that_is_not_cut_swallows_the_arm() -> None:
    robot = fetch()
    assert robot.simulation is not None
    whole = robot.simulation.model_copy(update={"convex_cells": {}})
    finding = only(check_robot(robot.model_copy(update={"simulation": whole})), "hull-swallows")
    assert "wrist_flex_link lies in the convex hull of torso_lift_link" in finding.message
    assert "torso_lift_link: {x: [" in finding.hint


def test_a_joint_without_force_is_told(rolling_proposal: Proposal, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(robot_file(rolling_proposal, tmp_path))
    finding = only(check_robot(read_robot(tmp_path)), "no-force")
    assert finding.severity.label == "warning"
    assert finding.message.endswith("roll")


def test_a_pose_that_collides_is_told_at_its_line(
    wrong: Wrong, rolling_proposal: Proposal, tmp_path: Path
) -> None:
    text = robot_file(rolling_proposal, tmp_path)
    block = text[text.index("  home:\n") : text.index("    head_pan", text.index("  home:\n"))]
    bent = "  home:\n    pan: 0\n    lift: 2\n    elbow: 2\n    flex: 0\n    roll: 0\n"
    findings = [f for f in wrong((block, bent)) if f.code == "pose-collides"]
    assert findings
    lines = (tmp_path / "robot.yaml").read_text().splitlines()
    for finding in findings:
        assert finding.severity.label == "error"
        assert "the pose home" in finding.message
        assert lines[finding.place.line - 1].strip() == "home:"


def test_a_footprint_that_the_wheels_leave(wrong: Wrong, rolling_proposal: Proposal) -> None:
    outline = rolling_proposal.stand.footprint
    assert outline is not None
    corners = "".join(f"  - [{x:g}, {y:g}]\n" for x, y in outline)
    small = "  - [0.25, -0.2]\n  - [0.25, 0.2]\n  - [-0.25, 0.2]\n  - [-0.25, -0.2]\n"
    finding = only(wrong((corners, small)), "footprint-too-small")
    assert "0.020 m" in finding.message
    large = small.replace("0.2]", "0.3]")
    assert only(wrong((corners, large)), "footprint-too-large").severity.label == "warning"


def test_a_robot_that_is_taller_than_it_says(wrong: Wrong, rolling_proposal: Proposal) -> None:
    height = f"height: {rolling_proposal.height:g}"
    finding = only(wrong((height, "height: 0.7")), "taller-than-height")
    assert finding.severity.label == "error"
    assert "0.7 m" in finding.message


def test_limits_beyond_the_urdf(wrong: Wrong) -> None:
    finding = only(wrong(("  lift: {lower: -2,", "  lift: {lower: -3,")), "limit-beyond-urdf")
    assert "lower of lift is -3" in finding.message
    text = (
        "  elbow: {lower: -2, upper: 2, velocity: 1",
        "  elbow: {lower: -2, upper: 2, velocity: 9",
    )
    assert only(wrong(text), "faster-than-urdf").severity.label == "warning"


def test_a_camera_in_its_own_mast(wrong: Wrong) -> None:
    turned = (
        "xyz: [0, 0, 0], rpy: [-1.5708, 0, -1.5708]",
        "xyz: [0, 0, 0], rpy: [-1.5708, 0, 1.5708]",
    )
    codes = {finding.code for finding in wrong(turned)}
    assert "camera-sees-itself" in codes


def test_a_camera_frame_that_is_no_optical_frame(wrong: Wrong) -> None:
    found = wrong(("    frame: head_camera_optical_frame", "    frame: head_camera_link"))
    assert "camera-tilted" in {finding.code for finding in found}


def test_a_laser_that_stands_on_edge_or_behind_the_mast(wrong: Wrong) -> None:
    frames = "frames:\n"
    edge = "frames:\n  edge: {on: base_laser_link, rpy: [90 deg, 0, 0]}\n"
    use = ("    frame: base_laser_link", "    frame: edge")
    assert "laser-tilted" in {f.code for f in wrong((frames, edge), use)}
    behind = "frames:\n  edge: {on: mast, xyz: [-0.05, 0, 0.5], rpy: [0, 0, 0]}\n"
    found = [f for f in wrong((frames, behind), use) if f.code == "laser-sees-itself"]
    assert found
    assert "laser" in found[0].message


@pytest.mark.parametrize(
    ("rpy", "code"),
    [("0, 1.5708, 1.5708", "grasp-frame-x"), ("0, -1.5708, 0", "grasp-frame-y")],
)
def test_a_grasp_frame_that_points_elsewhere(wrong: Wrong, rpy: str, code: str) -> None:
    found = wrong(("rpy: [0, -1.5708, 1.5708]", f"rpy: [{rpy}]"))
    assert code in {finding.code for finding in found}


def test_an_opening_that_does_not_fit_the_fingers(wrong: Wrong) -> None:
    found = wrong(("[0.08, 0.04]", "[0.08, 0.02]"))
    finding = only(found, "opening-does-not-fit")
    assert "0.024 m, the fingers' hulls are 0.012 m apart" in finding.message


def test_an_opening_beyond_the_range_of_its_joint(wrong: Wrong) -> None:
    found = wrong(("left_slide: [[0, 0], [0.08, 0.04]]", "left_slide: [[0, 0], [0.08, 0.09]]"))
    beyond = next(finding for finding in found if finding.code == "opening-beyond-limits")
    assert "left_slide asks for 0.09, and its range is 0 to 0.04" in beyond.message


def test_fingers_that_stand_still(wrong: Wrong) -> None:
    found = wrong(("[0.08, 0.04]", "[0.08, 0.00004]"))
    still = next(finding for finding in found if finding.code == "fingers-do-not-move")
    assert still.severity.label == "error"


def test_a_grasp_frame_beside_the_pads(wrong: Wrong, rolling_proposal: Proposal) -> None:
    assert rolling_proposal.grasp is not None
    place = rolling_proposal.grasp.link_from_grasp
    assert place is not None
    *_, ahead = place.position
    found = wrong((f"{ahead:.4f}".rstrip("0") + "], rpy: [0, -1.5708", "0.5], rpy: [0, -1.5708"))
    assert "no-pads-at-grasp" in {finding.code for finding in found}


def test_shapes_that_no_one_sees_between_the_fingers(rolling_urdf: Path, tmp_path: Path) -> None:
    guard = '<link name="guard"><collision><origin xyz="0 0 0.08"/><geometry>'
    guard += '<box size="0.14 0.08 0.14"/></geometry></collision></link>'
    guard += '<joint name="guarded" type="fixed"><parent link="palm"/><child link="guard"/></joint>'
    text = rolling_urdf.read_text().replace("</robot>", f"{guard}</robot>")
    (tmp_path / "guarded.urdf").write_text(text)
    proposal = propose(tmp_path / "guarded.urdf", samples=20)
    (tmp_path / "robot.yaml").write_text(robot_file(proposal, tmp_path))
    found = [f for f in check_robot(read_robot(tmp_path)) if f.code == "hand-is-filled"]
    assert len(found) == 1
    assert "nothing can be grasped: guard" in found[0].message
    assert found[0].severity.label == "error"


def test_a_pose_that_leaves_a_joint_open(wrong: Wrong) -> None:
    found = wrong(("    flex: -2\n    roll: 0.162\n    head_pan: 0\n", "    head_pan: 0\n"))
    open_poses = [finding for finding in found if finding.code == "pose-incomplete"]
    assert len(open_poses) == 3
    assert "the pose home leaves flex, roll open" in open_poses[0].message


def test_a_hand_that_meets_itself_when_closed(wrong: Wrong) -> None:
    pair = "[left_finger, right_finger]"
    line = f"ignored_collisions:\n  - {pair}    # default, met in 0%"
    finding = only(wrong((line, "ignored_collisions: []")), "closed-hand-collides")
    assert f"write {pair}" in finding.hint


def test_links_that_nobody_sees(rolling_proposal: Proposal, tmp_path: Path) -> None:
    text = rolling_proposal.prepared.source.read_text()
    (tmp_path / "bare.urdf").write_text(text.replace("visual>", "ignored>"))
    text = robot_file(rolling_proposal, tmp_path)
    source = next(line for line in text.splitlines() if "{urdf: " in line)
    (tmp_path / "robot.yaml").write_text(text.replace(source, "  r: {urdf: bare.urdf}"))
    found = [f for f in check_robot(read_robot(tmp_path)) if f.code == "invisible"]
    assert len(found) == 1
    assert "13 links" in found[0].message


def test_touch_links_without_fingers(wrong: Wrong) -> None:
    found = wrong(("touch_links: [palm, left_finger, right_finger]", "touch_links: [palm]"))
    assert "no-fingers" in {finding.code for finding in found}


def test_an_arm_without_usual_tables_is_told_which_it_reaches(rolling_proposal: Proposal) -> None:
    reach = replace(rolling_proposal.reach, tables=(0.1, 0.2))
    (lack,) = without(replace(rolling_proposal, reach=reach))
    assert "tables 0.1 to 0.2 m high" in lack
    assert "mounted higher" in lack
    assert "on tables 0.1 to 0.2 m high" in "\n".join(lines(replace(rolling_proposal, reach=reach)))
    reach = replace(rolling_proposal.reach, measured=False)
    (lack,) = without(replace(rolling_proposal, reach=reach))
    assert "no grasp on a table 0.1 to 1.2 m high" in lack


def test_working_distances_out_of_reach(wrong: Wrong, rolling_proposal: Proposal) -> None:
    near, best, far = rolling_proposal.reach.reach
    found = wrong((f"reach: [{near:g}, {best:g}, {far:g}]", "reach: [1.3, 1.4, 1.5]"))
    assert {f.code for f in found} == {"out-of-reach"}
    assert [f.severity.label for f in found] == ["error", "warning", "warning"]
    assert all("heights at which it is reached: " in f.message for f in found)
    found = wrong(("stand_off: 0.38", "stand_off: 0.2"))
    assert only(found, "stands-in-table").severity.label == "error"


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(a) for a in arguments], standalone_mode=False)
    if isinstance(result.exception, MomantuError):
        return result.exception.exit_code, result.exception.printed()
    assert result.exception is None, result.exception
    return result.return_value, result.output


def test_the_verb_by_path_in_words_and_as_json(rolling_proposal: Proposal, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(robot_file(rolling_proposal, tmp_path))
    code, said = run(tmp_path / "robot.yaml")
    assert code == 1
    assert "rolling_arm: 1 warning" in said
    code, said = run(tmp_path / "robot.yaml", "--json")
    told = json.loads(said)
    assert code == 1
    assert told["ok"] is False
    (finding,) = told["findings"]
    assert finding["code"] == "no-force"
    assert finding["line"] > 0
    assert finding["file"] == str(tmp_path / "robot.yaml")


def test_the_verb_by_name() -> None:
    assert run("fetch") == (0, "fetch: nothing is wrong\n")


def test_a_robot_that_there_is_not() -> None:
    with pytest.raises(PluginError, match="did you mean 'fetch'"):
        CliRunner().invoke(app, ["fetsch"], standalone_mode=False, catch_exceptions=False)


def test_a_shape_without_volume(rolling_proposal: Proposal, tmp_path: Path) -> None:
    corners = "vertex 0 0 0 vertex 1 0 0 vertex 0 1 0"
    facet = f"facet normal 0 0 1 outer loop {corners} endloop endfacet "
    (tmp_path / "flat.stl").write_text(f"solid flat {2 * facet}endsolid flat")
    text = rolling_proposal.prepared.source.read_text()
    (tmp_path / "flat.urdf").write_text(
        text.replace('<box size="0.04 0.04 0.6"/>', '<mesh filename="flat.stl"/>')
    )
    text = robot_file(rolling_proposal, tmp_path)
    source = next(line for line in text.splitlines() if "{urdf: " in line)
    (tmp_path / "robot.yaml").write_text(text.replace(source, "  r: {urdf: flat.urdf}"))
    code, said = run(tmp_path)
    assert code == 2
    assert "cannot be used" in said


def test_a_pose_in_which_only_the_open_hand_collides(
    rolling_proposal: Proposal, tmp_path: Path
) -> None:
    """Motions are planned with the opening that the hand has then."""
    (tmp_path / "robot.yaml").write_text(robot_file(rolling_proposal, tmp_path))
    robot = read_robot(tmp_path)
    model, draw = ArmModel(robot), np.random.default_rng(0)
    names, head = model.group.names, robot.actuators["head"].joints

    def free(q: np.ndarray, width: float) -> bool:
        pose = dict(zip(names, q, strict=True))
        return CollisionWorld(body_pairs(model), model.posture(pose, width), margin=0.004).free(q)

    postures = (draw.uniform(-2.0, 2.0, len(names)) for _ in range(5000))
    q = next(q for q in postures if free(q, 0.0) and not free(q, robot.hand.max_width))
    home = {**dict(zip(names, map(float, q), strict=True)), **dict.fromkeys(head, 0.0)}
    worse = robot.model_copy(update={"named_poses": {**robot.named_poses, "home": home}})
    found = [f for f in check_robot(worse) if f.code == "pose-collides"]
    assert found
    assert all("in the pose home" in f.message for f in found)


def test_every_pose_that_is_proposed_is_clear_with_any_opening(
    rolling_proposal: Proposal, tmp_path: Path
) -> None:
    (tmp_path / "robot.yaml").write_text(robot_file(rolling_proposal, tmp_path))
    robot = read_robot(tmp_path)
    model = ArmModel(robot)
    for name, pose in robot.named_poses.items():
        q = np.array([pose[joint] for joint in model.group.names])
        for width in np.linspace(0.0, robot.hand.max_width, 5):
            posture = model.posture(pose, float(width))
            assert CollisionWorld(body_pairs(model), posture, margin=0.004).free(q), (name, width)


def test_a_hand_that_carries_things_on_their_side(wrong: Wrong, rolling_proposal: Proposal) -> None:
    roll = rolling_proposal.poses["carry"].joints["roll"]
    text = robot_file(rolling_proposal, Path())
    block = text[text.index("  carry:\n") : text.index("  look_around:\n")]
    line = next(line for line in block.splitlines() if line.strip().startswith("roll:"))
    tipped = block.replace(line, f"    roll: {roll + 1.5708:.4f}")
    finding = next(f for f in wrong((block, tipped)) if f.code == "carry-not-level")
    assert "90 deg off the horizontal" in finding.message


def test_setup_says_that_what_is_carried_tips(rolling_proposal: Proposal) -> None:
    carry = replace(rolling_proposal.poses["carry"], notes=(TIPS,))
    tipping = replace(rolling_proposal, poses={**rolling_proposal.poses, "carry": carry})
    assert without(rolling_proposal) == ()
    (lack,) = without(tipping)
    assert lack.startswith("no level `carry`: no clear posture was found that holds the hand level")
