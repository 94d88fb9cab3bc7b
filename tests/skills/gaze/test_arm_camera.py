"""An arm that carries the camera brings it to where a point is seen."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from momantu_skills.look import Look
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_skills.manipulation.model.collision import CollisionWorld, Obstacle
from momantu_skills.manipulation.model.hulls import object_corners
from momantu_skills.manipulation.scene.site_obstacles import overhead_of

from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import DetectedObject, GripperCommand, JointTrajectory
from momantu_bt.testing import ScriptedRobot, eye_in_hand_robot, run_skill
from momantu_bt.testing.painting import Block, Painter, Solid
from momantu_bt.testing.world import scripted_site
from momantu_bt.world import Overhang, Surface
from tests.skills.scenery.table import SceneOf

TABLE = Block((0.8, 1.4, 0.72), (1.0, 0.0, 0.36))
"""Its edge is 0.6 m before the robot's middle."""
CAN = DetectedObject("can", Pose(Transform(), "odom", 0.0), (0.07, 0.07, 0.13), "cylinder", 1.0, 0)
ON_TOP = [(0.75, 0.0, 0.75), (0.9, 0.5, 0.72), (0.8, -0.6, 0.8), (1.2, 0.1, 0.72)]


def watcher(pose: str = "home", *, solids: tuple[Solid, ...] = (TABLE,)) -> ScriptedRobot:
    description = eye_in_hand_robot()
    robot = ScriptedRobot(description, joints=description.named_poses[pose])
    robot.readings = {"camera": Painter(list(solids))}
    return robot


def holding(robot: ScriptedRobot, scene: Any) -> Any:
    """The same with a can between the fingers, upright where the hand is level."""
    robot.object_width = robot.gripper_width = 0.07
    robot.command("gripper", GripperCommand(0.04, 40.0))
    robot.advance(0.05)
    scene.update(robot, robot.time)
    scene.grasped(CAN, Transform())
    return scene


def look(robot: ScriptedRobot, scene: Any, point: Any, **more: Any) -> Any:
    return run_skill(
        Look,
        robot=robot,
        inputs={"at": Pose(Transform(point), "odom", 0.0)},
        services={"planning_scene": scene},
        frames=scene.frames,
        **more,
    )


def in_camera(robot: ScriptedRobot, points: Any) -> np.ndarray:
    """Points in odom, in the optical frame."""
    eye = arm_model(robot.description).eye
    camera = robot.base.transform() @ eye.tip_pose(np.array([robot.joints[n] for n in eye.names]))
    return camera.inverse().apply(points)


def off_axis(optical: np.ndarray) -> float:
    return math.atan2(math.hypot(optical[0], optical[1]), optical[2])


def ways(robot: ScriptedRobot) -> list[np.ndarray]:
    """Joints along everything that the arm was told to do, each trajectory once."""
    told = {id(g): g for _, _, g in robot.commands if isinstance(g, JointTrajectory)}
    return [goal.positions for goal in told.values()]


@pytest.mark.parametrize("start", ["home", "ready", "look_around"])
@pytest.mark.parametrize("point", [*ON_TOP, (3.0, 0.5, 0.9), (0.9, 0.3, 0.1)])
def test_a_point_comes_to_lie_on_the_axis_where_its_depth_is_measured(
    scene_of: SceneOf, start: str, point: tuple[float, float, float]
) -> None:
    robot = watcher(start, solids=(TABLE,) if point in ON_TOP else ())
    result = look(robot, scene_of(robot), point)
    assert result.status == "SUCCESS", result.explain()
    seen, sensor = in_camera(robot, point), robot.description.camera()[1]
    assert off_axis(seen) < 0.03
    assert sensor.min_depth < seen[2] < sensor.max_depth
    assert all(abs(speed) < 0.05 for speed in robot.speeds.values())


@pytest.mark.parametrize("start", ["home", "look_around"])
def test_the_way_there_meets_neither_the_table_nor_the_robot(scene_of: SceneOf, start: str) -> None:
    robot = watcher(start)
    scene = scene_of(robot)
    for point in ON_TOP:
        assert look(robot, scene, point).status == "SUCCESS"
    table = [(x, y, z) for x in (0.6, 1.4) for y in (-0.7, 0.7) for z in (0.0, 0.72)]
    body = scene.scene
    world = CollisionWorld(
        body.own.pairs,
        body.model.configuration(robot.state()),
        [Obstacle("table", np.array(table))],
    )
    assert all(world.path_free(way) for way in ways(robot))


def test_what_is_held_stays_upright_and_out_of_the_way(scene_of: SceneOf) -> None:
    robot = watcher("carry")
    scene = holding(robot, scene_of(robot))
    model = scene.scene.model
    for point in ON_TOP:
        result = look(robot, scene, point)
        assert result.status == "SUCCESS", result.explain()
        seen = in_camera(robot, point)
        assert off_axis(seen) <= 0.10 + 0.02
        tip = model.group.tip_pose(np.array([robot.joints[n] for n in model.group.names]))
        can = in_camera(robot, (robot.base.transform() @ tip).apply(object_corners(CAN)))
        towards = can / np.linalg.norm(can, axis=1, keepdims=True)
        apart = np.arccos(towards @ seen / np.linalg.norm(seen))
        assert float(apart.min()) > math.radians(3.0)
    limit = 1.05 + 0.15
    for way in ways(robot):
        leans = [math.acos(min(1.0, model.group.tip_matrix(q)[2, 2])) for q in way]
        assert max(leans) < limit
    assert scene.held is not None


def test_a_load_that_fills_the_view_is_said_to(scene_of: SceneOf) -> None:
    robot = watcher("carry")
    scene = holding(robot, scene_of(robot))
    wall = DetectedObject("box", CAN.pose, (0.05, 0.5, 0.6), "box", 1.0, 0.0)
    scene.grasped(wall, Transform())
    result = look(robot, scene, ON_TOP[0])
    assert result.code == "OUT_OF_VIEW"
    assert "the box in the hand hides the view" in result.explain()
    assert ways(robot) == []


def test_the_same_look_is_the_same_motion(scene_of: SceneOf) -> None:
    first, second = watcher(), watcher()
    for robot in (first, second):
        assert look(robot, scene_of(robot), ON_TOP[1], seed=4).status == "SUCCESS"
    assert [w.tolist() for w in ways(first)] == [w.tolist() for w in ways(second)]


def test_a_point_that_is_seen_already_takes_little_motion(scene_of: SceneOf) -> None:
    robot = watcher()
    scene = scene_of(robot)
    assert look(robot, scene, ON_TOP[0]).status == "SUCCESS"
    before = dict(robot.joints)
    assert look(robot, scene, ON_TOP[0]).status == "SUCCESS"
    assert max(abs(robot.joints[name] - before[name]) for name in before) < 0.05


def test_what_stands_between_is_looked_round(scene_of: SceneOf) -> None:
    screen = Block((0.04, 0.5, 0.45), (0.75, 0.15, 0.95))
    robot = watcher("look_around", solids=(TABLE, screen))
    scene = scene_of(robot)
    scene.frames.set_map_from_odom(Transform(), 0.0)
    assert look(robot, scene, (0.72, 0.15, 0.95)).status == "SUCCESS"
    point = np.array((1.0, 0.0, 0.74))
    result = look(robot, scene, point)
    assert result.status == "SUCCESS", result.explain()
    eye = arm_model(robot.description).eye
    camera = eye.tip_pose(np.array([robot.joints[n] for n in eye.names])).position
    way = point - camera
    length = float(np.linalg.norm(way))
    assert float(screen.hit(camera, way[None] / length)[0]) > length


@pytest.mark.parametrize(
    ("start", "x", "depth", "bottom"),
    [("home", 0.9, 1.2, 0.985), ("look_around", 0.95, 0.7, 0.935)],
)
def test_what_hangs_over_a_table_is_looked_below(
    scene_of: SceneOf, start: str, x: float, depth: float, bottom: float
) -> None:
    """No picture shows the board: the site tells of it, and the arm keeps off it."""
    robot = watcher(start)
    scene, point = scene_of(robot), np.array((0.85, 0.0, 0.72))
    over = Overhang(Pose2D(x, 0.0, 0.0), (depth, 1.4), bottom, bottom + 0.03)
    table = Surface(Pose2D(1.0, 0.0, 0.0), (0.8, 1.4), 0.72, (math.pi,), (over,))
    (board,) = overhead_of(table, Transform())
    scene.site = scripted_site(surfaces={"table": table})
    scene.frames.set_map_from_odom(Transform(), 0.0)
    result = look(robot, scene, point)
    assert result.status == "SUCCESS", result.explain()
    eye = arm_model(robot.description).eye
    camera = eye.tip_pose(np.array([robot.joints[n] for n in eye.names])).position
    assert not board.between(camera, point)
    body, solid = scene.scene, board.obstacle(Transform(), "board")
    world = CollisionWorld(body.own.pairs, body.model.configuration(robot.state()), [solid])
    assert all(world.path_free(way) for way in ways(robot))


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.15), (-0.1, 0.0, 0.02), (60.0, 0.0, 1.0)])
def test_what_no_posture_sees_is_out_of_view(scene_of: SceneOf, point: Any) -> None:
    robot = watcher(solids=())
    result = look(robot, scene_of(robot), point)
    assert result.code == "OUT_OF_VIEW", result.explain()
    assert "drive nearer" in result.explain() or "in between" in result.explain()


def test_an_arm_that_does_not_move_is_the_cause(scene_of: SceneOf) -> None:
    robot = watcher()
    robot.frozen.add("arm")
    result = look(robot, scene_of(robot), ON_TOP[0])
    assert result.code == "OUT_OF_VIEW"
    assert result.failure.data["cause"] == "ARM_STUCK"
    assert "from where its trajectory asks it to be" in result.explain()


def test_a_base_that_is_turned_and_moved_makes_no_difference(scene_of: SceneOf) -> None:
    here = Pose2D(1.0, -2.0, 2.0)
    robot = watcher(solids=())
    robot.base = here
    point = here.transform().apply(ON_TOP[2])
    assert look(robot, scene_of(robot), point).status == "SUCCESS"
    assert off_axis(in_camera(robot, point)) < 0.03
