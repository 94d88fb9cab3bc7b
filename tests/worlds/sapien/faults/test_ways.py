"""The robot set down elsewhere, a crate in a doorway, a person before the robot."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.faults.floor_space import free_floor
from momantu_worlds.sapien.faults.rows import prepare
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.sensors.laser import Laser

from momantu_bt.fault import FaultError
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.messages import BaseVelocity, GripperCommand

LASER = fetch().laser()[0]
SEEDS = (0, 3, 6)


def ranges(stage: Stage) -> Array:
    laser = stage.simulator.robot.sensors[LASER]
    assert isinstance(laser, Laser)
    return laser.exact()


@pytest.mark.parametrize(("distance", "turn"), [(1.0, 1.0), (0.0, 2.0), (3.0, -0.5)])
def test_a_kidnapped_robot_stands_elsewhere_and_its_odometry_does_not_know(
    blind, happening, step, distance, turn
):
    stage = blind(3)
    robot, before = stage.simulator.robot, stage.base()
    odometry = robot.state().odom_from_base
    with happening(stage, "robot.kidnapped", distance=distance, turn=turn):
        step(stage, 3)
        moved = before.inverse() @ stage.base()
        away = math.hypot(moved.x, moved.y) - distance
        assert -1e-3 < away < 3.1
        assert away / 0.25 == pytest.approx(round(away / 0.25), abs=0.01)
        assert abs(moved.yaw) == pytest.approx(abs(turn), abs=1e-3)
        assert np.abs(robot.state().odom_from_base.position - odometry.position).max() < 1e-3


def test_who_drives_is_set_down_at_rest(blind, happening, step):
    stage = blind(3)
    step(stage, 10, base=BaseVelocity(0.0, 1.0))
    with happening(stage, "robot.kidnapped", distance=1.0, turn=1.0):
        after = stage.base()
        step(stage, 1)
        assert abs((after.inverse() @ stage.base()).yaw) < 0.02
        step(stage, 20)
        assert stage.simulator.truth.base_speed() == pytest.approx((0.0, 0.0), abs=1e-3)


def test_what_it_holds_comes_along(carrying, happening, step):
    stage, grip = carrying, GripperCommand(0.0, 40.0)
    hand = stage.simulator.truth.link("gripper_link")
    before = hand.inverse() @ stage.item_pose()
    with happening(stage, "robot.kidnapped", distance=1.0, turn=1.0):
        step(stage, 20, gripper=grip)
        after = stage.simulator.truth.link("gripper_link").inverse() @ stage.item_pose()
        assert np.abs(after.position - before.position).max() < 2e-3
        assert stage.held()
        assert stage.referee.verdict().incidents == ()
    step(stage, 10, gripper=grip)
    assert stage.held()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_blocked_doorway_cuts_the_way_to_the_item(blind, happening, seed):
    stage = blind(seed)
    base, item = stage.base(), stage.item_pose().position

    def there_is_a_way() -> bool:
        floor = free_floor(stage)
        ends = [floor.nearest_free(p) for p in ((base.x, base.y), (item[0], item[1]))]
        return len(floor.route(*ends)) > 0

    assert there_is_a_way()
    with happening(stage, "doorway.blocked"):
        assert not there_is_a_way()
        (crate,) = stage.simulator.added
        door = stage.episode.doorways["south_west_door"].at
        assert math.dist(crate.map_from_body.position[:2], door) < 0.2
    assert there_is_a_way()


def test_the_doorway_ahead_is_the_next_one_on_the_way(blind, happening):
    stage, robot = blind(3), blind(3).simulator.robot
    corridor = stage.episode.site.places["corridor"]
    door = stage.episode.doorways["south_door"].at
    with happening(stage, "robot.kidnapped", distance=0.0, turn=0.0):
        robot.carry(corridor)
        with happening(stage, "doorway.blocked"):
            (crate,) = stage.simulator.added
            assert math.dist(crate.map_from_body.position[:2], door) < 0.2
        robot.carry(Pose2D(door[0], door[1] + 0.2, -1.57))
        with happening(stage, "doorway.blocked"):
            (crate,) = stage.simulator.added
            assert math.dist(crate.map_from_body.position[:2], door) > 1.0


def test_with_the_item_in_the_hand_the_way_goes_to_the_other_table(carrying, happening):
    base, table = carrying.base(), carrying.simulator.truth.pose("table_b").position
    with happening(carrying, "doorway.blocked"):
        floor = free_floor(carrying)
        ends = [floor.nearest_free(p) for p in ((base.x, base.y), (table[0], table[1]))]
        assert len(floor.route(*ends)) == 0


def test_the_laser_sees_a_crate_in_the_doorway_while_it_stands_there(blind, happening):
    stage, robot = blind(3), blind(3).simulator.robot
    before = stage.base()
    door = stage.episode.doorways["south_west_door"].at
    robot.carry(Pose2D(door[0], door[1] - 1.5, math.pi / 2))
    middle = len(ranges(stage)) // 2
    free = ranges(stage)[middle]
    with happening(stage, "doorway.blocked"):
        assert ranges(stage)[middle] < 1.5
    assert ranges(stage)[middle] == free > 2.0
    robot.carry(before)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_person_stands_a_metre_ahead_and_steps_away(blind, happening, step, seed):
    stage = blind(seed)
    before = ranges(stage)
    with happening(stage, "person.in_way"):
        (person,) = stage.simulator.added
        there = stage.base().inverse() @ Pose2D.from_transform(person.map_from_body)
        assert 1.0 <= math.hypot(there.x, there.y) < 2.3
        assert abs(math.atan2(there.y, there.x)) < math.radians(46)
        seen = ranges(stage)
        nearer = np.flatnonzero(seen < before - 0.05)
        assert len(nearer) > 5
        assert 0.5 < seen[nearer].min() < 2.0
        step(stage, 2)
    assert np.allclose(ranges(stage), before, atol=1e-3)


def test_who_backs_off_meets_the_person_behind(blind, happening, step):
    stage = blind(0)
    step(stage, 2, base=BaseVelocity(-0.2, 0.0))
    with happening(stage, "person.in_way"):
        (person,) = stage.simulator.added
        there = stage.base().inverse() @ Pose2D.from_transform(person.map_from_body)
        assert there.x < 0.0


def test_nobody_steps_between_the_robot_and_a_wall(blind, fault, step):
    stage, robot = blind(3), blind(3).simulator.robot
    before, wall = stage.base(), stage.simulator.truth.pose("wall_outer_west").position
    robot.carry(Pose2D(float(wall[0]) + 0.6, -2.6, math.pi))
    with pytest.raises(FaultError, match="no room for a person"):
        prepare(stage, fault("person.in_way")).begin()
    robot.carry(before)
