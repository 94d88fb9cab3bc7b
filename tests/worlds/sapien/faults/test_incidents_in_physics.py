"""What a robot does is told by ground truth: it lets go, pushes, still moves; others' deeds not."""

from __future__ import annotations

import pytest

from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions

HOLD, OPEN = GripperCommand(0.0, 40.0), GripperCommand(0.1, 40.0)


def incidents(stage, kind):
    return [i for i in stage.referee.verdict().incidents if i.kind == kind]


def test_opening_the_hand_above_a_surface_is_a_drop(new_carrying, step):
    stage = new_carrying()
    step(stage, 4, gripper=HOLD)
    assert incidents(stage, "dropped") == []
    before = stage.simulator.now()
    step(stage, 20, gripper=OPEN)
    (drop,) = incidents(stage, "dropped")
    assert drop.value == pytest.approx(0.15, abs=0.02)
    assert f"can left the hand {drop.value:.2f} m above post" in drop.sentence
    assert before < drop.time <= before + 1.0


def test_slipping_out_of_a_weak_hand_is_a_drop_too(new_carrying, step):
    stage = new_carrying()
    step(stage, 30, gripper=GripperCommand(0.0, 0.5))
    assert len(incidents(stage, "dropped")) == 1


def test_setting_it_down_before_letting_go_is_none(new_carrying, step):
    stage = new_carrying()
    names = stage.description.actuators["arm"].joints
    carry = stage.description.named_poses["carry"]
    low = tuple({**carry, "torso_lift_joint": 0.2}[name] for name in names)
    step(stage, 60, gripper=HOLD, arm=JointPositions(names, low))
    step(stage, 20, gripper=OPEN)
    step(stage, 5)
    assert not stage.held()
    assert stage.referee.verdict().incidents == ()


def test_what_somebody_takes_away_was_not_dropped(new_carrying, happening, step):
    stage = new_carrying()
    with happening(stage, "object.removed"):
        step(stage, 10, gripper=HOLD)
        assert stage.referee.verdict().incidents == ()


def test_driving_on_into_a_person_is_one_blow(new_carrying, happening, step):
    stage = new_carrying()
    with happening(stage, "person.in_way"):
        step(stage, 60, base=BaseVelocity(0.5, 0.0), gripper=HOLD)
        blows = incidents(stage, "force")
        assert blows
        assert all(blow.value > 150.0 for blow in blows)
        assert len({blow.sentence.split(" with ")[0] for blow in blows}) == len(blows)
        assert any("pushed person with" in blow.sentence for blow in blows)


def test_who_drives_at_the_verdict_still_moves(blind, step):
    stage = blind(0)
    assert incidents(stage, "moving") == []
    step(stage, 10, base=BaseVelocity(0.0, 0.5), head=JointPositions(("head_pan_joint",), (1.0,)))
    (turning,) = incidents(stage, "moving")
    assert turning.value == pytest.approx(0.5, abs=0.1)
    assert "the base still moves at 0.5" in turning.sentence
    step(stage, 40)
    assert incidents(stage, "moving") == []
    step(stage, 5, gripper=GripperCommand(0.0, 10.0))
    assert {i.sentence.split(" ")[0] for i in incidents(stage, "moving")} == {
        "r_gripper_finger_joint",
        "l_gripper_finger_joint",
    }
