"""The item is moved, tipped over, taken away, and taken out of the hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_worlds.sapien.faults.rows import prepare
from momantu_worlds.sapien.faults.tops import item_top
from momantu_worlds.scenes.referee.demand import tilt

from momantu_bt.fault import FaultError
from momantu_bt.geometry import Transform
from momantu_bt.messages import GripperCommand

SEEDS = (0, 3, 6)


@pytest.mark.parametrize("distance", [0.03, 0.08, 0.15])
def test_a_moved_item_stands_as_far_off_on_the_same_top(blind, happening, step, distance):
    stage = blind(3)
    before, top = stage.item_pose(), item_top(stage)
    with happening(stage, "object.moved", distance=distance):
        step(stage, 10)
        after = stage.item_pose()
        shift = after.position - before.position
        assert np.hypot(*shift[:2]) == pytest.approx(distance, abs=2e-3)
        assert abs(shift[2]) < 1e-3
        assert tilt(after) < 0.01
        assert item_top(stage).name == top.name


@pytest.mark.parametrize("name", ["object.moved", "object.knocked_over", "camera.phantom"])
def test_where_the_origin_of_an_item_is_changes_nothing(new_stage, happening, step, name):
    told = {"object.moved": {"distance": 0.08}, "camera.phantom": {"frames": 3}}.get(name, {})
    poses = []
    for foot in (None, Transform((0.02, 0.01, -0.07))):
        stage = new_stage(3, render=name == "camera.phantom", foot=foot)
        with happening(stage, name, **told):
            step(stage)
            shown = [stage.item.foot_at(b.map_from_body) for b in stage.simulator.added]
            poses.append([stage.item_pose(), *shown])
    for plain, other in zip(*poses, strict=True):
        assert other.position == pytest.approx(plain.position, abs=2e-3)
        assert other.angle_to(plain) < 0.01


def test_what_finds_no_room_does_not_happen(blind, fault):
    stage = blind(3)
    before = stage.item_pose()
    with pytest.raises(FaultError, match="nothing is free 1.9 m from can on table_a"):
        prepare(stage, fault("object.moved", distance=1.9)).begin()
    assert stage.item_pose() == before


@pytest.mark.parametrize("seed", SEEDS)
def test_a_tipped_item_lies_on_its_top_and_comes_to_rest(blind, happening, step, seed):
    stage = blind(seed)
    name = item_top(stage).name
    with happening(stage, "object.knocked_over"):
        step(stage, 40)
        assert tilt(stage.item_pose()) == pytest.approx(math.pi / 2, abs=0.02)
        assert item_top(stage).name == name
        assert stage.simulator.truth.speed("can")[0] < 0.03


def test_a_removed_item_is_far_from_everything(blind, happening, step):
    stage = blind(3)
    with happening(stage, "object.removed"):
        step(stage, 5)
        pose, truth = stage.item_pose(), stage.simulator.truth
        others = [truth.pose(b).position for b in truth.bodies if b != "can"]
        assert min(np.hypot(*(o - pose.position)[:2]) for o in others) > 5.0
        assert tilt(pose) < 0.01
        with pytest.raises(FaultError, match="stands on no table"):
            item_top(stage)


def test_only_what_is_held_is_lost(blind, fault):
    with pytest.raises(FaultError, match="can is not in the hand now"):
        prepare(blind(3), fault("object.lost")).begin()


def test_what_is_in_the_hand_is_not_moved_by_others(carrying, fault):
    for name, parameters in (("object.moved", {"distance": 0.1}), ("object.knocked_over", {})):
        with pytest.raises(FaultError, match="can is between the fingers now"):
            prepare(carrying, fault(name, **parameters)).begin()


def test_a_lost_item_lies_on_the_floor_beside_the_robot_which_dropped_nothing(
    carrying, happening, step
):
    stage = carrying
    assert stage.held()
    with happening(stage, "object.lost"):
        step(stage, 20, gripper=GripperCommand(0.0, 40.0))
        assert not stage.held()
        assert stage.simulator.robot.state().gripper_width < 0.01
        pose, base = stage.item_pose(), stage.base()
        assert pose.position[2] == pytest.approx(0.035, abs=2e-3)
        assert math.hypot(pose.position[0] - base.x, pose.position[1] - base.y) < 2.0
        assert not [
            c
            for c in stage.simulator.truth.contacts()
            if "can" in (c.first, c.second) and c.first in stage.simulator.truth.robot_links
        ]
        assert stage.referee.verdict().incidents == ()
