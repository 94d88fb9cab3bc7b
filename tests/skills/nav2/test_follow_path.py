"""FollowPath: along the path, onto a new one without a stop, and not into what stands there."""

from typing import Any

import numpy as np
import pytest
from momantu_skills.nav2.follow_path import FollowPath
from momantu_skills.nav2.service import Nav2Service
from momantu_skills.navigation.drive.track import Track
from momantu_skills.navigation.drive.ways import posed

from momantu_bt.geometry import Path, Pose2D
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import Flat

START = Pose2D(-2.5, 0.9, 0.0)


def _line(*points: tuple[float, float], yaw: float = 0.0) -> Path:
    return posed(np.array(points), yaw)


BEND = _line((-2.5, 0.9), (-0.5, 0.9), (-0.5, -1.0), yaw=-1.57)


def test_it_stays_near_the_path_and_ends_there(flat: Flat, act: Act) -> None:
    world, far = flat(START), []

    def note(session: Any, world: Any) -> None:
        truth = world.robot.truth
        far.append(min(truth.distance_to(pose) for pose in BEND))

    result = act(FollowPath, world, path=BEND, on_tick=note)
    assert result.status == "SUCCESS", result.explain()
    assert world.robot.truth.distance_to(BEND[-1]) < 0.25
    assert abs((BEND[-1].inverse() @ world.robot.truth).yaw) < 0.25
    assert max(far) < 0.35
    told = result.outputs["tracking_feedback"]
    assert told.distance_to_goal < 0.3
    assert told.remaining_path_length < 0.3
    assert told.current_path_index > len(BEND) - 5
    assert result.outputs["error_code_id"] == 0


def test_a_new_path_is_taken_over_without_a_stop(flat: Flat, act: Act) -> None:
    world, speeds = flat(START), []
    other = _line((-2.5, 0.9), (2.0, 0.9))

    def replace(session: Any, world: Any) -> None:
        if world.now() > 4.0:
            session.skill.port_values["path"] = other
        if 3.5 < world.now() < 4.6:
            speeds.append(world.robot.linear)

    first = _line((-2.5, 0.9), (1.5, 0.9))
    result = act(FollowPath, world, path=first, on_tick=replace)
    assert result.status == "SUCCESS", result.explain()
    assert world.robot.truth.distance_to(other[-1]) < 0.3
    assert min(speeds) > 0.3


def test_a_new_path_each_half_second_costs_no_speed(flat: Flat, act: Act) -> None:
    """A tree that plans again at 2 Hz: the base must not wait for the next look at the path."""
    world, speeds = flat(START), []
    first = _line((-2.5, 0.9), (2.0, 0.9))
    second = _line((-2.5, 0.92), (2.0, 0.9))

    def replace(session: Any, world: Any) -> None:
        session.skill.port_values["path"] = (first, second)[int(2.0 * world.now()) % 2]
        if 3.0 < world.now() < 4.5:
            speeds.append(world.robot.linear)

    result = act(FollowPath, world, path=first, on_tick=replace)
    assert result.status == "SUCCESS", result.explain()
    assert min(speeds) > 0.4


def test_around_something_that_was_not_there(flat: Flat, act: Act) -> None:
    world = flat(START, hidden=[(-1.0, 0.7, -0.7, 1.1)])
    path = _line((-2.5, 0.9), (0.3, 0.9))
    result = act(FollowPath, world, path=path)
    assert result.status == "SUCCESS", result.explain()
    assert world.robot.nearest > 0.01


def test_out_and_back_it_goes_to_the_turning_point(flat: Flat, act: Act) -> None:
    """A path that comes back must be driven to its far end."""
    path = _line((-2.5, 0.9), (-0.5, 0.9), (-2.0, 0.9), yaw=3.14)
    world, farthest = flat(START), []

    def note(session: Any, world: Any) -> None:
        farthest.append(world.robot.truth.x)

    result = act(FollowPath, world, path=path, on_tick=note)
    assert result.status == "SUCCESS", result.explain()
    assert max(farthest) > -1.2
    assert world.robot.truth.distance_to(path[-1]) < 0.3


def test_a_track_never_goes_back() -> None:
    path = _line((0.0, 0.0), (2.0, 0.0), (2.0, 2.0))
    track = Track(path, Pose2D(0.0, 0.0))
    seen = []
    for pose in (*path, *reversed(path)):
        track.advance(pose)
        seen.append(track.at)
    assert seen == sorted(seen)
    assert track.at == len(path) - 1
    assert track.to_go == 0.0


def test_errors_have_nav2s_signs() -> None:
    track = Track(_line((0.0, 0.0), (2.0, 0.0)), Pose2D(1.0, 0.1))
    assert track.errors(Pose2D(1.0, 0.1, 0.0)) == pytest.approx((0.1, 0.0))
    assert track.errors(Pose2D(1.0, -0.1, -0.2)) == pytest.approx((-0.1, 0.2))


def test_a_tree_cancels_it(flat: Flat, act: Act) -> None:
    world, nav2 = flat(START), Nav2Service()

    def cancel(session: Any, world: Any) -> None:
        if 4.0 < world.now() < 4.06:
            nav2.cancel("FollowPath")

    result = act(FollowPath, world, nav2=nav2, path=BEND, on_tick=cancel)
    assert result.status == "SUCCESS", result.explain()
    assert result.duration < 6.0
    assert abs(world.robot.linear) < 0.02


@pytest.mark.parametrize(
    ("inputs", "code", "number"),
    [
        ({"path": ()}, "INVALID_PATH", 103),
        ({"path": _line((-2.5, 0.9), (30.0, 0.9))}, "INVALID_PATH", 103),
        ({"path": BEND, "controller_id": "DWB"}, "INVALID_CONTROLLER", 101),
        ({"path": BEND, "goal_checker_id": "magic"}, "INVALID_CONTROLLER", 101),
    ],
)
def test_each_failure_has_nav2s_number(
    flat: Flat, act: Act, inputs: dict[str, Any], code: str, number: int
) -> None:
    result = act(FollowPath, flat(START), **inputs)
    assert result.code == code, result.explain()
    assert result.skill.error_code_id == number  # type: ignore[union-attr]


def test_patience_exceeded_where_no_way_leads_on(flat: Flat, act: Act) -> None:
    world = flat(START)

    def wall_in(session: Any, world: Any) -> None:
        if 1.5 < world.now() < 1.56:
            at = world.robot.truth
            world.robot.boxes += [
                (at.x + 1.0, -3.0, at.x + 1.1, 3.0),
                (at.x - 1.4, -3.0, at.x - 1.3, 3.0),
            ]

    result = act(FollowPath, world, path=_line((-2.5, 0.9), (2.5, 0.9)), on_tick=wall_in)
    assert result.code == "PATIENCE_EXCEEDED", result.explain()
    assert result.skill.error_code_id == 104  # type: ignore[union-attr]
    assert abs(world.robot.linear) < 0.02
    assert world.robot.nearest > 0.0


def test_failed_to_make_progress_when_the_base_does_not_move(flat: Flat, act: Act) -> None:
    world = flat(START)

    def hold(session: Any, world: Any) -> None:
        world.robot.base = Pose2D(0.0, 0.0, 0.0)
        world.robot.truth = START

    result = act(FollowPath, world, path=BEND, on_tick=hold)
    assert result.code == "FAILED_TO_MAKE_PROGRESS", result.explain()
    assert result.skill.error_code_id == 105  # type: ignore[union-attr]


def test_no_valid_control_when_the_laser_stops_every_command(flat: Flat, act: Act) -> None:
    """A wall closes in around the robot while it drives."""
    world = flat(START)

    def close_in(session: Any, world: Any) -> None:
        if world.now() > 3.5 and len(world.robot.boxes) < 12:
            at = world.robot.truth
            world.robot.boxes += [
                (at.x + 0.45, at.y - 1.0, at.x + 0.5, at.y + 1.0),
                (at.x - 1.0, at.y + 0.40, at.x + 1.0, at.y + 0.45),
                (at.x - 1.0, at.y - 0.45, at.x + 1.0, at.y - 0.40),
            ]

    result = act(FollowPath, world, path=BEND, on_tick=close_in)
    assert result.code == "NO_VALID_CONTROL", result.explain()
    assert result.skill.error_code_id == 106  # type: ignore[union-attr]


def test_tf_error_when_it_is_not_localized(flat: Flat, act: Act) -> None:
    world = flat(Pose2D(20.0, 20.0, 0.0), believed=Pose2D(-2.0, 0.0, 0.0))
    world.robot.boxes += [(19.0, 19.0, 19.1, 21.0), (21.0, 19.0, 21.1, 21.0)]
    result = act(FollowPath, world, path=BEND)
    assert result.code == "TF_ERROR", result.explain()
    assert result.skill.error_code_id == 102  # type: ignore[union-attr]
