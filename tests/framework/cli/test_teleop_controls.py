"""Keys as commands: which ones there are, for how long they count, and their greatest speeds."""

from __future__ import annotations

import io
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console, ConsoleDimensions

from momantu_bt.cli.teleop.abilities import abilities, drivers
from momantu_bt.cli.teleop.controls import HAND, HELD, Controls
from momantu_bt.cli.teleop.picture import Seen, picture
from momantu_bt.robot import BaseKind
from momantu_bt.teleoperation import DEAD_MAN, STANDING, Command
from momantu_bt.testing import eye_in_hand_robot, small_robot
from momantu_bt.tree.registry import Registry

ROBOT = small_robot()
ALL = {"base": "b", "arm": "a", "head": "h", "gripper": "g"}
KEYS = [*"wsadqeikjluoIKJLUOWSADtgcvm+-.,=123", " ", "up", "down", "left", "right", "escape"]


def controls(driven=ALL, robot=ROBOT) -> Controls:
    return Controls(abilities(robot, driven))


def still(command: Command) -> bool:
    moved = (command.linear, command.angular, *command.hand, *command.joints.values())
    return not any(moved) and command.opening is None


def held(seat: Controls, key: str, since: float, until: float, rate: float = 30.0) -> float:
    """Press a key as a keyboard repeats it; the time of the last repetition."""
    seat.press(key, since)
    at = since + 0.4
    while at < until:
        seat.press(key, at)
        last, at = at, at + 1.0 / rate
    return last


@given(st.lists(st.tuples(st.sampled_from(KEYS), st.floats(0.01, 0.7)), max_size=60))
def test_no_keys_make_anything_faster_than_the_robot_allows(pressed):
    seat, now = controls(), 0.0
    base = ROBOT.base
    for key, pause in pressed:
        seat.press(key, now)
        for moment in (now, now + pause):
            command = seat.command(moment)
            assert abs(command.linear) <= base.linear
            assert abs(command.angular) <= base.angular
            assert all(abs(v) <= HAND[i > 2] for i, v in enumerate(command.hand))
            for name, speed in command.joints.items():
                assert abs(speed) <= ROBOT.joint_limits[name].velocity
            assert command.opening in (None, 0.0, ROBOT.end_effector.max_width)
            assert command.stamp == moment
        now += pause


@given(st.lists(st.sampled_from(KEYS), max_size=30))
def test_without_a_key_all_stands_still_after_the_dead_mans_time(pressed):
    seat = controls()
    for key in pressed:
        seat.press(key, 1.0)
    assert still(seat.command(1.0 + DEAD_MAN))


def test_a_key_that_is_held_goes_on_and_ends_sooner():
    seat = controls()
    last = held(seat, "w", 1.0, 3.0)
    assert seat.command(last + HELD - 0.01).linear > 0.0
    assert still(seat.command(last + HELD))


def test_the_keyboards_first_pause_is_bridged():
    seat = controls()
    seat.press("w", 1.0)
    assert seat.command(1.0 + 0.45).linear > 0.0


@pytest.mark.parametrize(
    ("key", "signs"),
    [
        ("w", (1, 0)),
        ("up", (1, 0)),
        ("s", (-1, 0)),
        ("a", (0, 1)),
        ("left", (0, 1)),
        ("d", (0, -1)),
        ("q", (1, 1)),
        ("e", (1, -1)),
    ],
)
def test_keys_of_the_base(key, signs):
    seat = controls()
    seat.press(key, 0.0)
    command = seat.command(0.05)
    found = [int(math.copysign(1, v)) if v else 0 for v in (command.linear, command.angular)]
    assert tuple(found) == signs
    assert command.hand == STANDING


@pytest.mark.parametrize(
    ("key", "axis", "way"),
    [("i", 0, 1), ("k", 0, -1), ("j", 1, 1), ("l", 1, -1), ("u", 2, 1), ("o", 2, -1), ("J", 5, 1)],
)
def test_keys_of_the_hand(key, axis, way):
    seat = controls()
    seat.press(key, 0.0)
    hand = seat.command(0.05).hand
    assert [i for i, v in enumerate(hand) if v] == [axis]
    assert hand[axis] * way > 0.0


def test_the_base_and_the_arm_are_driven_at_once_and_one_key_each():
    seat = controls()
    for key in "wiau":
        seat.press(key, 0.0)
    command = seat.command(0.05)
    assert (command.linear, command.angular > 0.0) == (0.0, True)
    assert [i for i, v in enumerate(command.hand) if v] == [2]


def test_single_joints_are_chosen_by_number_and_by_neighbour():
    seat = controls()
    seat.press("2", 0.0)
    assert "press m first" in seat.said
    for key, joint in (("m", "lift"), ("2", "shoulder"), ("l", "elbow"), ("l", "lift")):
        seat.press(key, 0.0)
        assert seat.joint == joint
    seat.press("9", 0.0)
    assert seat.said == "the arm has 3 joints"
    seat.press("j", 0.0)
    seat.press("i", 0.0)
    command = seat.command(0.05)
    assert command.hand == STANDING
    assert dict(command.joints) == {"elbow": pytest.approx(0.3 * 1.5)}


def test_a_lift_and_a_head_have_keys_of_their_own():
    seat = controls()
    for key, joint, way in (
        ("t", "lift", 1),
        ("g", "lift", -1),
        ("A", "pan", 1),
        ("W", "tilt", -1),
        ("S", "tilt", 1),
    ):
        seat.press(" ", 0.0)
        seat.press(key, 0.0)
        ((name, speed),) = seat.command(0.05).joints.items()
        assert (name, speed * way > 0.0) == (joint, True), key


def test_space_stops_everything_once():
    seat = controls()
    for key in "wic":
        seat.press(key, 0.0)
    seat.press(" ", 0.0)
    first, second = seat.command(0.05), seat.command(0.1)
    assert (first.stop, still(first), second.stop) == (True, True, False)


@pytest.mark.parametrize("key", ["x", "leave"])
def test_leaving_ends_every_command(key):
    seat = controls()
    seat.press("w", 0.0)
    seat.press(key, 0.0)
    command = seat.command(0.05)
    assert (command.ended, still(command)) == (True, True)


def test_speeds_change_between_bounds():
    seat = controls()
    for _ in range(50):
        seat.press("+", 0.0)
        seat.press(".", 0.0)
    assert seat.base_speed == (ROBOT.base.linear, ROBOT.base.angular)
    assert seat.hand_speed == HAND
    for _ in range(50):
        seat.press("-", 0.0)
        seat.press(",", 0.0)
    assert 0.0 < seat.base_speed[0] < 0.1 * ROBOT.base.linear
    assert 0.0 < seat.hand_speed[0] < 0.1 * HAND[0]


@pytest.mark.parametrize(
    ("missing", "keys"),
    [("base", "wsad+"), ("arm", "ijuUm.t2"), ("head", "WASD"), ("gripper", "cv")],
)
def test_what_a_robot_lacks_is_not_offered(missing, keys):
    seat = controls({name: skill for name, skill in ALL.items() if name != missing})
    shown = text(seat, 80, 24)
    assert missing.upper() not in shown
    for key in keys:
        seat.press(key, 0.0)
        assert seat.said == f"the key {key!r} has no meaning here"
        assert still(seat.command(0.05))


def test_an_arm_with_a_camera_is_no_head():
    able = abilities(eye_in_hand_robot(), {"base": "b", "arm": "a", "gripper": "g"})
    assert (able.pan, able.tilt, able.lift) == (None, None, None)


def text(seat: Controls, width: int, height: int, **more: object) -> str:
    seen = Seen("teleop: small in room", 12.3, 1.0, None, {}, "")
    console = Console(width=width, height=height, record=True, file=io.StringIO())
    console.print(picture(seat, replace(seen, **more), ConsoleDimensions(width, height)))
    return console.export_text()


@pytest.mark.parametrize("by_joints", [False, True])
@pytest.mark.parametrize(("width", "height"), [(80, 24), (60, 15), (40, 8), (10, 3), (200, 50)])
def test_the_screen_fits_and_keeps_what_each_part_does(by_joints, width, height):
    seat = controls()
    seat.by_joints = by_joints
    lines = text(seat, width, height, doing={"base": "stopped: obstacle"}).splitlines()
    assert len(lines) <= height
    assert max(map(len, lines)) <= width
    if height >= 8 and width >= 40:
        shown = "\n".join(lines)
        assert "stopped: obstacle" in shown
        assert all(word in shown for word in ("ARM", "HEAD", "GRIPPER", "x leave"))


def test_at_80x24_every_key_is_explained():
    seat = controls()
    shown = text(seat, 80, 24)
    for words in ("w ahead", "i ahead", "U O roll", "t up", "W up", "c close", "SPACE stop"):
        assert words in shown
    seat.press("m", 0.0)
    assert "1 lift" in text(seat, 80, 24)


def test_a_slow_world_is_told():
    assert "0.5 x real time" in text(controls(), 80, 24, pace=0.5)


def test_skills_drive_what_a_robot_has():
    whole = drivers(Registry.installed(), ROBOT)
    assert whole.keys() == {"base", "arm", "head", "gripper"}
    bare = {n: a for n, a in ROBOT.actuators.items() if n in ("base", "head")}
    armless = ROBOT.model_copy(
        update={"actuators": bare, "groups": {}, "end_effector": None, "named_poses": {}}
    )
    driven = drivers(Registry.installed(), armless)
    assert driven.keys() == {"base", "head"}
    able = abilities(armless, driven)
    assert (dict(able.joints), able.opening, able.lift) == ({}, None, None)
    blind = armless.model_copy(update={"sensors": {}})
    assert drivers(Registry.installed(), blind) == {}


def test_the_camera_on_an_arm_is_driven_with_the_arm():
    driven = drivers(Registry.installed(), eye_in_hand_robot())
    assert driven.keys() == {"base", "arm", "gripper"}


def test_a_base_that_drives_sideways_slides_and_others_do_not():
    limits = ROBOT.base.model_copy(update={"kind": BaseKind.OMNIDIRECTIONAL, "lateral": 0.5})
    seat = controls(robot=ROBOT.model_copy(update={"base": limits}))
    for key, way in (("[", 1.0), ("]", -1.0)):
        seat.press(key, 0.0)
        command = seat.command(0.0)
        assert command.lateral == pytest.approx(way * seat.base_share * 0.5)
        assert command.linear == command.angular == 0.0
    others = controls()
    others.press("[", 0.0)
    assert others.command(0.0).lateral == 0.0
    assert "no meaning" in others.said
