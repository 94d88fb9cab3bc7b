"""ValidatePath and its kin: what the costmap says about paths, poses and goals."""

from typing import Any

import numpy as np
import pytest
from momantu_skills.nav2.validate import (
    CheckPoseOccupancy,
    IsPathValid,
    RemoveInCollisionGoals,
    ValidatePath,
)
from momantu_skills.navigation.drive.ways import posed

from momantu_bt.geometry import Pose2D
from momantu_bt.skill import Skill
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import START, Flat

PATH = posed(np.array([(-2.0, 0.0), (0.3, 0.0)]), 0.0)
BOX = (-1.0, -0.3, -0.7, 0.3)


@pytest.mark.parametrize("kind", [ValidatePath, IsPathValid])
def test_a_free_path_is_valid(flat: Flat, act: Act, kind: type[Skill]) -> None:
    assert act(kind, flat(START), path=PATH).status == "SUCCESS"


@pytest.mark.parametrize("kind", [ValidatePath, IsPathValid])
def test_path_invalid_where_the_laser_sees_something(
    flat: Flat, act: Act, kind: type[Skill]
) -> None:
    result = act(kind, flat(START, hidden=[BOX]), path=PATH)
    assert result.code == "PATH_INVALID", result.explain()


def test_it_reports_the_poses_in_collision(flat: Flat, act: Act) -> None:
    world = flat(START, hidden=[BOX])
    first = act(ValidatePath, world, path=PATH).skill.collision_poses  # type: ignore[union-attr]
    result = act(ValidatePath, flat(START, hidden=[BOX]), path=PATH, stop_at_first_collision=False)
    every = result.skill.collision_poses  # type: ignore[union-attr]
    assert len(first) == 1
    assert len(every) > 1
    assert every[0] == first[0]
    assert all(abs(pose.x + 0.85) < 0.6 for pose in every)


def test_only_as_far_ahead_as_it_is_asked(flat: Flat, act: Act) -> None:
    world = flat(START, hidden=[BOX])
    assert act(ValidatePath, world, path=PATH, max_lookahead_distance=0.3).status == "SUCCESS"


@pytest.mark.parametrize(
    ("footprint", "code"),
    [
        ("[[0.1, 0.1], [0.1, -0.1], [-0.1, -0.1], [-0.1, 0.1]]", None),
        ("[[0.1, 0.9], [0.1, -0.9], [-0.1, -0.9], [-0.1, 0.9]]", "PATH_INVALID"),
        ("wide", "BAD_FOOTPRINT"),
        ("[[1, 2]]", "BAD_FOOTPRINT"),
    ],
)
def test_with_another_footprint(flat: Flat, act: Act, footprint: str, code: str | None) -> None:
    world = flat(START, hidden=[(-1.0, 0.6, -0.7, 1.0)])
    assert act(ValidatePath, world, path=PATH, footprint=footprint).code == code


def test_a_path_without_poses_is_invalid(flat: Flat, act: Act) -> None:
    assert act(ValidatePath, flat()).code == "PATH_INVALID"


@pytest.mark.parametrize(
    ("pose", "code"),
    [
        (Pose2D(-1.0, 1.0), None),
        ("left", None),
        (Pose2D(3.9, 0.2), "POSE_OCCUPIED"),
        (Pose2D(50.0, 0.0), "POSE_OCCUPIED"),
        ("kitchen", "BAD_GOAL"),
    ],
)
def test_whether_the_base_could_stand_there(
    flat: Flat, act: Act, pose: Any, code: str | None
) -> None:
    assert act(CheckPoseOccupancy, flat(), pose=pose).code == code


def test_goals_in_collision_are_removed(flat: Flat, act: Act) -> None:
    goals = (Pose2D(-1.0, 1.0), Pose2D(3.9, 0.2), "left")
    result = act(RemoveInCollisionGoals, flat(), input_goals=goals)
    assert result.outputs["output_goals"] == (goals[0], "left")
    result = act(RemoveInCollisionGoals, flat(), input_goals=(goals[1],))
    assert result.code == "POSE_OCCUPIED"
    assert act(RemoveInCollisionGoals, flat()).outputs["output_goals"] == ()
    assert act(RemoveInCollisionGoals, flat(), input_goals=("kitchen",)).code == "BAD_GOAL"
