"""`robots preview`: pictures in which the robot, the can and the frames are where they must be."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.preview import robot_sheet as sheet_module
from momantu_worlds.preview.robot_scene import robot_episode
from momantu_worlds.preview.robot_sheet import GAP, HEIGHT, LINE, WIDTH, robot_sheet
from momantu_worlds.robots import fetch
from momantu_worlds.verbs.robots_preview import preview
from PIL import Image
from typer import Typer
from typer.testing import CliRunner

from momantu_bt.errors import MomantuError
from momantu_bt.plugins import PluginError
from momantu_bt.robot import RobotDescription
from momantu_bt.world import WorldError

app = Typer()
app.command()(preview)


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(a) for a in arguments], standalone_mode=False)
    if isinstance(result.exception, MomantuError):
        return result.exception.exit_code, result.exception.printed()
    assert result.exception is None, result.exception
    return result.return_value, result.output


@pytest.fixture(scope="module")
def robot() -> RobotDescription:
    return fetch()


@pytest.fixture(scope="module")
def pixels(robot: RobotDescription) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(robot_sheet(robot)))).astype(int)


def row(pixels: np.ndarray, number: int) -> tuple[np.ndarray, np.ndarray]:
    """The pose's picture and the camera's, without their titles."""
    top = GAP + number * (HEIGHT + LINE + GAP) + LINE
    whole = pixels[top : top + HEIGHT]
    return whole[:, GAP : GAP + WIDTH], whole[:, 2 * GAP + WIDTH : -GAP]


def red(picture: np.ndarray) -> float:
    r, g, b = picture[..., 0], picture[..., 1], picture[..., 2]
    return float(((r > 100) & (g < 60) & (b < 60)).mean())


def test_a_row_for_every_pose(robot: RobotDescription, pixels: np.ndarray) -> None:
    assert pixels.shape[0] == GAP + len(robot.named_poses) * (HEIGHT + LINE + GAP)
    poses = [row(pixels, i)[0] for i in range(len(robot.named_poses))]
    for i, one in enumerate(poses):
        for other in poses[i + 1 :]:
            assert np.abs(one - other).mean() > 0.2


def test_the_camera_sees_the_can_on_the_table(pixels: np.ndarray) -> None:
    ready, look_around = row(pixels, 1)[1], row(pixels, 3)[1]
    assert 0.003 < red(ready) < 0.1
    assert 0.003 < red(look_around) < 0.1


def test_frames_are_drawn_on_poses_alone(pixels: np.ndarray) -> None:
    axis = np.array(sheet_module.COLORS[2])
    pose, eye = row(pixels, 2)
    assert (np.abs(pose - axis).max(axis=-1) == 0).sum() > 50
    assert (np.abs(eye - axis).max(axis=-1) == 0).sum() == 0


def test_the_robot_touches_nothing_that_stands_there(robot: RobotDescription) -> None:
    episode = robot_episode(robot)
    front = max(x for x, _ in robot.footprint)
    table = episode.body("table")
    assert table.map_from_body.position[0] - 0.3 > front
    assert episode.body("can").map_from_body.position[2] > 0.7


def test_the_verb_writes_a_png(
    robot: RobotDescription, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sheet_module, "robot_sheet", lambda description: b"picture")
    monkeypatch.chdir(tmp_path)
    assert run("fetch") == (0, "fetch.png: fetch, 4 poses\n")
    assert (tmp_path / "fetch.png").read_bytes() == b"picture"
    code, _ = run("fetch", "-o", "mine.png")
    assert code == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["fetch.png", "mine.png"]


@pytest.mark.parametrize(
    ("out", "words"), [("a.jpg", "not a .png file"), ("nowhere/a.png", "no folder")]
)
def test_a_file_that_cannot_be_is_refused(out: str, words: str, tmp_path: Path) -> None:
    code, said = run("fetch", "-o", tmp_path / out)
    assert code == 2
    assert words in said


def test_an_unknown_robot_is_told() -> None:
    with pytest.raises(PluginError, match="did you mean 'fetch'"):
        CliRunner().invoke(app, ["fetsh"], standalone_mode=False, catch_exceptions=False)


def test_a_robot_that_cannot_be_simulated(
    robot: RobotDescription, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bare = robot.model_copy(update={"simulation": None})
    with pytest.raises(WorldError):
        robot_sheet(bare)
    monkeypatch.setattr("momantu_worlds.verbs.robots_preview.load_robot", lambda name: bare)
    code, said = run("fetch", "-o", tmp_path / "a.png")
    assert code == 3
    assert "simulat" in said


BOX = """\
momantu_robot: 1
name: box
parts: {box: {urdf: box.urdf}}
mounts: {box: {on: base_footprint, xyz: [0, 0, 0.15]}}
base_frame: base_footprint
footprint: [[-0.25, -0.2], [0.25, -0.2], [0.25, 0.2], [-0.25, 0.2]]
height: 0.3
working: {stand_off: 0.38, look_off: 0.56}
base:
  kind: differential
  linear: 0.8
  angular: 1.5
  linear_acceleration: 0.8
  angular_acceleration: 2.0
  drive: {force: 50, torque: 10}
actuators: {base: {kind: base}}
sensors: {}
simulation: {floor_links: [body], finger_links: [], finger_friction: 1.0}
"""
URDF = """\
<robot name="box"><link name="body">
<visual><geometry>{visual}</geometry></visual>
<collision><geometry>{collision}</geometry></collision>
<inertial><mass value="10"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
</link></robot>
"""


@pytest.mark.parametrize("content", ["this is no mesh", ""])
@pytest.mark.parametrize("role", ["visual", "collision"])
def test_a_mesh_that_cannot_be_read_is_told_with_its_link(
    role: str, content: str, tmp_path: Path
) -> None:
    shapes = dict.fromkeys(("visual", "collision"), '<box size="0.5 0.4 0.3"/>')
    shapes[role] = '<mesh filename="body.stl"/>'
    (tmp_path / "body.stl").write_text(content)
    (tmp_path / "box.urdf").write_text(URDF.format(**shapes))
    (tmp_path / "robot.yaml").write_text(BOX)
    code, said = run(tmp_path / "robot.yaml", "-o", tmp_path / "box.png")
    assert code == 3
    assert f"the {role} mesh {tmp_path / 'body.stl'} of the link 'body' cannot be read" in said
    assert "write it anew as STL" in said
    assert not (tmp_path / "box.png").exists()
