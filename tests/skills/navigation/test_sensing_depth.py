"""A depth picture gives obstacles in the base's way and bare floor, without the robot itself."""

import numpy as np
import pytest
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.sensing import obstacles_and_floor

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Transform
from momantu_bt.messages import CameraImage
from momantu_bt.testing import ScriptedRobot

SIZE = (240, 320)
INTRINSICS = np.array([[280.0, 0, 159.5], [0, 280.0, 119.5], [0, 0, 1]])


class _Scene:
    """Everything within 0.6 m of the base's axis is the robot."""

    def is_robot(self, points: np.ndarray, state: object) -> np.ndarray:
        return np.hypot(points[:, 0], points[:, 1]) < 0.6


def _picture(
    robot: ScriptedRobot, box: tuple[float, float, float], turned: float = 0.0
) -> CameraImage:
    """Floor and a board (x, z from, z to), 1 m wide, as the tilted camera sees them.

    turned: how far the camera looks up more than its robot believes, rad.
    """
    frame = robot.description.camera()[1].frame
    camera = robot.description.kinematics().base_from_frame(frame, robot.joints)
    camera = camera @ Transform.from_rpy((0.0, 0.0, 0.0), (turned, 0.0, 0.0))
    v, u = np.mgrid[0 : SIZE[0], 0 : SIZE[1]]
    rays = np.stack([(u - 159.5) / 280.0, (v - 119.5) / 280.0, np.ones(SIZE)], axis=-1)
    ways = rays @ camera.rotation.T
    start = camera.position
    with np.errstate(divide="ignore", invalid="ignore"):
        floor = np.where(ways[..., 2] < -1e-6, -start[2] / ways[..., 2], np.inf)
        board = (box[0] - start[0]) / ways[..., 0]
    y, z = start[1] + board * ways[..., 1], start[2] + board * ways[..., 2]
    on_board = (board > 0) & (abs(y) < 0.5) & (z > box[1]) & (z < box[2])
    depth = np.where(on_board & (board < floor), board, floor)
    depth = np.where((depth > 0.35) & (depth < 4.5), depth, 0.0)
    color = np.zeros((*SIZE, 3), np.uint8)
    return CameraImage(robot.time, frame, color, depth.astype(np.float32), INTRINSICS)


def _seen(box: tuple[float, float, float], turned: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    robot = ScriptedRobot(joints={"tilt": 0.5})
    frames = FrameBuffer(robot.description.kinematics())
    frames.add_state(robot.state())
    return obstacles_and_floor(
        _picture(robot, box, turned),
        frames,
        robot.description,
        robot.state(),
        _Scene(),  # type: ignore[arg-type]
        NavigationConfig(),
    )


def test_a_board_that_hangs_above_the_laser_is_an_obstacle() -> None:
    obstacles, floor = _seen((1.8, 0.5, 0.7))
    assert len(obstacles) > 20
    assert np.abs(obstacles[:, 0] - 1.8).max() < 0.01
    assert np.abs(obstacles[:, 1]).max() < 0.52
    assert len(floor) > 50


def test_bare_floor_is_no_obstacle() -> None:
    obstacles, floor = _seen((50.0, 0.0, 1.0))
    assert len(obstacles) == 0
    assert np.hypot(*floor.T).max() <= NavigationConfig().depth_reach


def test_what_is_higher_than_the_robot_is_let_be() -> None:
    assert len(_seen((2.0, 1.25, 2.0))[0]) == 0


def test_the_robot_itself_is_left_out() -> None:
    obstacles, _ = _seen((0.45, 0.2, 0.9))
    assert (np.hypot(*obstacles[:, :2].T) >= 0.6).all()


def test_far_things_wait_until_they_are_near() -> None:
    assert len(_seen((NavigationConfig().depth_reach + 0.2, 0.2, 0.9))[0]) == 0


@pytest.mark.parametrize("turned", [-0.015, 0.0, 0.015])
@pytest.mark.parametrize("ahead", [1.2, 1.5, 1.8])
def test_what_lies_on_the_floor_is_seen_by_a_camera_that_is_tilted(
    ahead: float, turned: float
) -> None:
    obstacles, _ = _seen((ahead, 0.0, 0.07), turned)
    assert len(obstacles) > 5
    assert obstacles[:, 2].max() < 0.08
    assert np.abs(obstacles[:, 0] - ahead).max() < 0.05


@pytest.mark.parametrize("turned", [-0.015, 0.015])
def test_bare_floor_is_bare_for_a_camera_that_is_tilted(turned: float) -> None:
    obstacles, floor = _seen((50.0, 0.0, 1.0), turned)
    assert len(obstacles) == 0
    assert len(floor) > 50


def test_a_floor_that_leans_more_than_it_may_is_no_floor() -> None:
    obstacles, _ = _seen((50.0, 0.0, 1.0), -0.1)
    assert len(obstacles) > 50
