"""NavigateToPose, NavigateThroughPoses: whole trips."""

from typing import Any

import pytest
from momantu_skills.nav2.navigators import NavigateThroughPoses, NavigateToPose

from momantu_bt.claim import BaseAt
from momantu_bt.geometry import Pose2D
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import START, Flat

GOAL = Pose2D(2.5, -1.0, 0.0)


def test_to_a_pose_in_the_next_room(flat: Flat, act: Act) -> None:
    world = flat(START)
    result = act(NavigateToPose, world, goal=GOAL)
    assert result.status == "SUCCESS", result.explain()
    assert world.robot.truth.distance_to(GOAL) < 0.3
    assert result.claim() == BaseAt(GOAL, pytest.approx(0.3), pytest.approx(0.28))
    assert world.robot.nearest > 0.0


def test_through_poses_in_turn(flat: Flat, act: Act) -> None:
    world, near = flat(START), [9.0, 9.0]
    goals = (Pose2D(-2.0, 1.5, 0.0), Pose2D(0.0, 0.9, 0.0))

    def note(session: Any, world: Any) -> None:
        for k, goal in enumerate(goals):
            near[k] = min(near[k], world.robot.truth.distance_to(goal))

    result = act(NavigateThroughPoses, world, goals=("left", goals[1]), on_tick=note)
    assert result.status == "SUCCESS", result.explain()
    assert max(near) < 0.3


@pytest.mark.parametrize(
    ("inputs", "code", "number"),
    [
        ({"goal": "kitchen"}, "BAD_GOAL", 9000),
        ({"goal": GOAL, "behavior_tree": "a.xml"}, "FAILED_TO_LOAD_BEHAVIOR_TREE", 9001),
        ({"goal": Pose2D(3.9, 0.2)}, "UNREACHABLE", 9000),
    ],
)
def test_each_failure_has_nav2s_number(
    flat: Flat, act: Act, inputs: dict[str, Any], code: str, number: int
) -> None:
    result = act(NavigateToPose, flat(START), **inputs)
    assert result.code == code, result.explain()
    assert result.skill.error_code_id == number  # type: ignore[union-attr]


def test_no_goals_and_tf_error(flat: Flat, act: Act) -> None:
    assert act(NavigateThroughPoses, flat(), goals=()).code == "BAD_GOAL"
    world = flat(Pose2D(20.0, 20.0, 0.0), believed=START)
    world.robot.boxes += [(19.0, 19.0, 19.1, 21.0), (21.0, 19.0, 21.1, 21.0)]
    result = act(NavigateToPose, world, goal=GOAL)
    assert (result.code, result.skill.error_code_id) == ("TF_ERROR", 9002)  # type: ignore[union-attr]
