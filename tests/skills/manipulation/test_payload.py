"""The weight in the hand: told beside the empty hand's load, and only where it can be told."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.hand.between_pads import between_pads
from momantu_skills.manipulation.scene.payload import BIAS, Payload, mean_weight

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Transform, quaternion_from_axis_angle
from momantu_bt.messages import WrenchReading, frozen
from momantu_bt.service import Snapshot
from momantu_bt.testing import ScriptedRobot, small_robot
from tests.skills.scenery.table import SceneOf, Tabletop


class Wrist:
    """A robot whose wrist measures `force`; its hand may weigh something and be turned."""

    def __init__(self, force: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        robot = ScriptedRobot(small_robot())
        self.name = next(n for n, s in robot.description.sensors.items() if s.kind == "wrench")
        self.robot, self.force, self.dead = robot, np.array(force), False
        robot.readings[self.name] = lambda _: WrenchReading(
            robot.time,
            robot.description.sensors[self.name].frame,
            frozen(self.force.copy()),
            frozen(np.zeros(3)),
        )
        self.frames = FrameBuffer(robot.description.kinematics())
        self.frames.add_state(robot.state())
        self.payload = Payload(robot.description, self.frames)

    def measure_empty(self, ticks: int = 100) -> None:
        for _ in range(ticks):
            self.robot.advance(0.05)
            self.frames.add_state(self.robot.state())
            self.payload.update(self.robot, self.robot.state())

    @property
    def frame(self) -> str:
        return self.robot.description.sensors[self.name].frame

    @property
    def up(self) -> np.ndarray:
        return self.frames.lookup("odom", self.frame).rotation[2]


def test_the_weight_is_what_the_load_has_grown_by() -> None:
    wrist = Wrist((0.9, -0.7, 0.5))
    wrist.measure_empty()
    assert wrist.payload.weigh(wrist.robot).value == pytest.approx(0.0)
    wrist.force = wrist.force - 3.9 * wrist.up
    weight = wrist.payload.weigh(wrist.robot)
    assert weight.value == pytest.approx(3.9)
    assert weight.shared < 0.2 * BIAS
    many = mean_weight([weight] * 16)
    assert many.noise == pytest.approx(weight.noise / 4)
    assert many.aside == pytest.approx(weight.aside)
    assert many.shared == pytest.approx(weight.shared)


@pytest.mark.parametrize("empty", [0.0, 2.0])
def test_a_push_from_the_side_is_told_beside_the_weight(empty: float) -> None:
    wrist = Wrist()
    odom_from_sensor = wrist.frames.lookup("odom", wrist.frame).rotation
    wrist.force = empty * odom_from_sensor[0]
    wrist.measure_empty()
    wrist.force = wrist.force + odom_from_sensor.T @ (3.0, -4.0, -3.9)
    weight = wrist.payload.weigh(wrist.robot)
    assert weight.value == pytest.approx(3.9)
    assert weight.aside == pytest.approx((3.0, -4.0))


def test_a_sensor_that_feels_the_hands_own_weight_tells_no_push_from_the_side() -> None:
    wrist = Wrist()
    wrist.force = -15.0 * wrist.up
    wrist.measure_empty()
    assert math.isnan(math.hypot(*wrist.payload.weigh(wrist.robot).aside))


def test_a_short_contact_of_the_open_hand_does_not_count() -> None:
    wrist = Wrist()
    wrist.measure_empty()
    wrist.force = 12.0 * wrist.up
    wrist.measure_empty(20)
    wrist.force = 0.0 * wrist.up
    assert wrist.payload.weigh(wrist.robot).value == pytest.approx(0.0)


def test_a_hand_that_was_never_seen_empty_is_weighed_less_surely() -> None:
    wrist = Wrist()
    assert wrist.payload.weigh(wrist.robot).sigma > BIAS


def test_a_closed_hand_is_not_taken_for_an_empty_one() -> None:
    wrist = Wrist()
    wrist.force = -3.9 * wrist.up
    wrist.robot.gripper_width = 0.07
    wrist.measure_empty()
    assert wrist.payload.weigh(wrist.robot).value == pytest.approx(3.9)


def test_nothing_is_weighed_in_motion_or_without_an_answer() -> None:
    wrist = Wrist()
    wrist.robot.linear = 0.3
    assert wrist.payload.weigh(wrist.robot) is None
    wrist.robot.linear = 0.0
    wrist.robot.dead.add(wrist.name)
    assert wrist.payload.weigh(wrist.robot) is None


@pytest.mark.parametrize(("own", "told"), [(0.5, True), (14.0, False)])
def test_a_hand_whose_own_weight_is_measured_is_not_weighed_when_turned(
    own: float, told: bool
) -> None:
    wrist = Wrist()
    wrist.force = -own * wrist.up
    wrist.measure_empty()
    tilted = replace(
        wrist.robot.state(),
        stamp=wrist.robot.time + 0.05,
        odom_from_base=Transform(
            (0.0, 0.0, 0.0), quaternion_from_axis_angle((0.0, 1.0, 0.0), math.radians(40.0))
        ),
    )
    wrist.robot.advance(0.05)
    wrist.frames.add_state(tilted)
    assert (wrist.payload.weigh(wrist.robot) is not None) is told


def test_a_robot_without_a_sensor_at_the_wrist_weighs_nothing() -> None:
    description = without_wrist(small_robot())
    payload = Payload(description, FrameBuffer(description.kinematics()))
    assert payload.weigh(ScriptedRobot(description)) is None


@pytest.mark.parametrize("held", [True, False])
def test_a_picture_shows_what_is_between_the_pads(
    tabletop: type[Tabletop], scene_of: SceneOf, held: bool
) -> None:
    """Fetch's head looks down at the hand before the chest."""
    robot = tabletop(pose="carry", can=(0.75, 0.0) if held else None)
    if held:
        robot.hold(Transform())
    else:
        robot.gripper_width = 0.07
    frames = FrameBuffer(robot.description.kinematics())
    hand = robot.odom_from_hand.position
    robot.joints["head_pan_joint"] = math.atan2(hand[1], hand[0])
    robot.joints["head_tilt_joint"] = 0.8
    frames.add_state(robot.state())
    name, camera = robot.description.camera()
    snapshot = Snapshot(
        robot.read(name),
        frames.lookup("odom", camera.frame),
        frames.lookup("odom", robot.description.base_frame),
        robot.state(),
    )
    view = between_pads(scene_of(robot).scene, snapshot)
    assert (view.points >= 25) is held
    assert (view.through >= 0.5) is not held


def test_a_hand_counts_as_raised_above_where_its_fingers_moved(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(can=None, pose="carry")
    scene = scene_of(robot)

    def later(lift: float, width: float) -> bool:
        robot.gripper_width = width
        robot.joints["torso_lift_joint"] += lift
        robot.advance(0.3)
        scene.frames.add_state(robot.state())
        scene.update(robot, robot.time)
        return scene.payload.raised

    robot.joints["torso_lift_joint"] = 0.1
    assert not later(0.0, 0.07)
    assert not later(0.02, 0.07)
    assert later(0.03, 0.07)
    assert not later(0.0, 0.065), "the fingers moved"
    assert not later(-0.1, 0.065)
    assert later(0.05, 0.065), "from its lowest place"


def without_wrist(description: Any) -> Any:
    kept = {n: s for n, s in description.sensors.items() if s.kind != "wrench"}
    return description.model_copy(update={"sensors": kept})


@pytest.mark.parametrize(("moves", "weighed"), [(False, True), (True, False)])
def test_joints_that_shake_and_stay_where_they_are_stand_still(moves: bool, weighed: bool) -> None:
    wrist = Wrist()
    wrist.measure_empty()
    plain, at = wrist.robot.state, 0.0
    for _ in range(3):
        at += 0.02 if moves else 0.0
        wrist.robot.advance(0.05)
        state = plain()
        shaken = replace(
            state,
            velocities=frozen(np.full(len(state.names), 0.3)),
            positions=frozen(np.asarray(state.positions) + at),
        )
        wrist.frames.add_state(shaken)
        wrist.robot.state = lambda shaken=shaken: shaken  # type: ignore[method-assign]
        wrist.payload.update(wrist.robot, shaken)
    assert (wrist.payload.weigh(wrist.robot) is not None) is weighed
