"""Spin, BackUp, DriveOnHeading, Wait: how far they go, and why they stop."""

from __future__ import annotations

from typing import Any

import pytest
from momantu_skills.nav2.recoveries import BackUp, DriveOnHeading, Spin, Wait
from momantu_skills.nav2.service import Nav2Service

from momantu_bt.geometry import Pose2D
from momantu_bt.skill import Skill
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import START, Flat


def _moved(world: Any) -> Pose2D:
    return START.inverse() @ world.robot.truth


@pytest.mark.parametrize("angle", [1.57, -0.6, 4.0])
def test_spin_turns_by_the_angle_on_the_spot(flat: Flat, act: Act, angle: float) -> None:
    world = flat(drift=0.0)
    result = act(Spin, world, spin_dist=angle)
    assert result.status == "SUCCESS", result.explain()
    left = (Pose2D(0, 0, angle).inverse() @ Pose2D(0, 0, _moved(world).yaw)).yaw
    assert abs(left) < 0.06
    assert world.robot.truth.distance_to(START) < 0.02


@pytest.mark.parametrize(
    ("kind", "inputs", "ahead"),
    [
        (BackUp, {"backup_dist": 0.3, "backup_speed": 0.15}, -0.3),
        (DriveOnHeading, {"dist_to_travel": 1.0, "speed": 0.3}, 1.0),
        (DriveOnHeading, {"dist_to_travel": -0.4, "speed": -0.2}, -0.4),
    ],
)
def test_straight_drives_end_after_their_distance(
    flat: Flat, act: Act, kind: type[Skill], inputs: dict[str, Any], ahead: float
) -> None:
    world = flat(drift=0.0)
    fastest: list[float] = []
    result = act(kind, world, on_tick=lambda s, w: fastest.append(abs(w.robot.linear)), **inputs)
    assert result.status == "SUCCESS", result.explain()
    assert _moved(world).x == pytest.approx(ahead, abs=0.03)
    assert max(fastest) < abs(inputs.get("speed", inputs.get("backup_speed"))) + 0.02
    assert result.outputs["error_code_id"] == 0


def test_wait_takes_the_time_of_the_world(flat: Flat, act: Act) -> None:
    result = act(Wait, flat(), wait_duration=2.0)
    assert result.status == "SUCCESS"
    assert result.duration == pytest.approx(2.0, abs=0.11)


BEHIND = [(-2.6, -1.0, -2.5, 1.0)]
AHEAD = [(-1.5, -1.0, -1.4, 1.0)]
BESIDE = [(-2.3, 0.32, -1.7, 0.4), (-2.3, -0.4, -1.7, -0.32)]


@pytest.mark.parametrize(
    ("kind", "inputs", "hidden", "code", "number"),
    [
        (Spin, {"spin_dist": 6.0, "time_allowance": 1.0}, [], "TIMEOUT", 701),
        (BackUp, {"backup_dist": 1.0, "time_allowance": 1.0}, [], "TIMEOUT", 711),
        (DriveOnHeading, {"dist_to_travel": 1.0, "time_allowance": 1.0}, [], "TIMEOUT", 721),
        (DriveOnHeading, {"dist_to_travel": 1.0, "speed": 0.3}, AHEAD, "COLLISION_AHEAD", 723),
        (DriveOnHeading, {"dist_to_travel": 1.0, "speed": -0.3}, [], "INVALID_INPUT", 724),
        (DriveOnHeading, {"dist_to_travel": 0.0, "speed": 0.0}, [], "INVALID_INPUT", 724),
        (BackUp, {"backup_speed": 0.0}, [], "INVALID_INPUT", 713),
    ],
)
def test_each_failure_has_nav2s_number(
    flat: Flat,
    act: Act,
    kind: type[Skill],
    inputs: dict[str, Any],
    hidden: list[Any],
    code: str,
    number: int,
) -> None:
    world = flat(hidden=hidden)
    result = act(kind, world, **inputs)
    assert result.code == code, result.explain()
    assert result.skill.error_code_id == number  # type: ignore[union-attr]
    assert result.skill.error_msg  # type: ignore[union-attr]
    assert world.robot.nearest > 0.0


def test_back_up_stops_before_what_the_map_has_behind(flat: Flat, act: Act) -> None:
    world = flat(Pose2D(-3.5, 0.0, 0.0))
    result = act(BackUp, world, backup_dist=1.0, backup_speed=0.2)
    assert (result.code, result.skill.error_code_id) == ("COLLISION_AHEAD", 714)  # type: ignore[union-attr]
    assert world.robot.nearest > 0.0


def test_spin_stops_where_its_corners_would_touch(flat: Flat, act: Act) -> None:
    world = flat(known=[(-2.25, 0.27, -1.4, 0.4), (-2.25, -0.4, -1.4, -0.27)])
    result = act(Spin, world, spin_dist=1.57)
    assert (result.code, result.skill.error_code_id) == ("COLLISION_AHEAD", 703)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("kind", "inputs"),
    [
        (Spin, {"spin_dist": 6.0}),
        (BackUp, {"backup_dist": 1.0}),
        (DriveOnHeading, {"dist_to_travel": 2.0, "speed": 0.2}),
        (Wait, {"wait_duration": 20.0}),
    ],
)
def test_a_tree_cancels_them(
    flat: Flat, act: Act, kind: type[Skill], inputs: dict[str, Any]
) -> None:
    world, nav2 = flat(), Nav2Service()

    def cancel(session: Any, world: Any) -> None:
        if 0.96 < world.now() < 1.02:
            nav2.cancel(kind.__name__)

    result = act(kind, world, nav2=nav2, on_tick=cancel, **inputs)
    assert result.status == "SUCCESS", result.explain()
    assert result.duration < 3.0
    assert abs(world.robot.linear) < 0.02
