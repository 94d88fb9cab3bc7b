"""Clearing: what was seen is gone where it should be, and the map stays."""

from typing import Any

import numpy as np
import pytest
from momantu_skills.nav2.cancel import (
    CancelBackUp,
    CancelControl,
    CancelDriveOnHeading,
    CancelSpin,
    CancelWait,
)
from momantu_skills.nav2.compute_path import ComputePathToPose
from momantu_skills.nav2.costmap import (
    ClearCostmapAroundPose,
    ClearCostmapAroundRobot,
    ClearCostmapExceptRegion,
    ClearEntireCostmap,
)
from momantu_skills.nav2.localization import ReinitializeGlobalLocalization
from momantu_skills.nav2.service import Nav2Service

from momantu_bt.geometry import Pose2D
from momantu_bt.skill import Skill
from momantu_bt.testing import ScriptedWorld
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import START, Flat

BOX = Pose2D(-0.9, 0.0)
"""Something 1 m ahead of the robot that the map does not have."""


@pytest.fixture
def seen(flat: Flat, act: Act) -> tuple[ScriptedWorld, Nav2Service]:
    """A world, and a costmap in which the laser has seen a box."""
    world, nav2 = flat(START, hidden=[(-1.0, -0.2, -0.8, 0.2)]), Nav2Service()
    assert act(ComputePathToPose, world, nav2=nav2, goal="left").status == "SUCCESS"
    return world, nav2


def _room(nav2: Nav2Service, pose: Pose2D) -> float:
    return nav2.costmap.room(pose, np.array([[0.0, 0.0, 0.0]]))


@pytest.mark.parametrize(
    ("kind", "inputs", "cleared"),
    [
        (ClearEntireCostmap, {}, True),
        (ClearEntireCostmap, {"plugins": ("obstacle_layer",)}, True),
        (ClearCostmapExceptRegion, {"reset_distance": 1.0}, True),
        (ClearCostmapExceptRegion, {"reset_distance": 4.0}, False),
        (ClearCostmapAroundRobot, {"reset_distance": 1.0}, False),
        (ClearCostmapAroundRobot, {"reset_distance": 4.0}, True),
        (ClearCostmapAroundPose, {"pose": BOX, "reset_distance": 1.0}, True),
        (ClearCostmapAroundPose, {"pose": "right", "reset_distance": 1.0}, False),
    ],
)
def test_what_is_cleared(
    seen: tuple[ScriptedWorld, Nav2Service],
    kind: type[Skill],
    inputs: dict[str, Any],
    cleared: bool,
) -> None:
    world, nav2 = seen
    before = _room(nav2, Pose2D(-1.0, 0.0))
    assert before < 0.1
    skill = kind()
    skill.port_values.update(inputs)
    skill.services = {"nav2_servers": nav2, "localization": _At(START)}
    skill.site = world.site
    assert list(skill.run(world.robot)) == []
    assert (_room(nav2, Pose2D(-1.0, 0.0)) > before + 0.1) is cleared
    assert _room(nav2, Pose2D(1.05, -1.0)) <= 0.05  # a wall of the map


class _At:
    def __init__(self, pose: Pose2D) -> None:
        self.map_from_base = pose


def test_unknown_layer(flat: Flat, act: Act) -> None:
    result = act(ClearEntireCostmap, flat(), plugins=("inflation_layer",))
    assert result.code == "UNKNOWN_LAYER"


def test_bad_goal_of_a_clearing(flat: Flat, act: Act) -> None:
    assert act(ClearCostmapAroundPose, flat(), pose="kitchen").code == "BAD_GOAL"


@pytest.mark.parametrize(
    ("kind", "action"),
    [
        (CancelControl, "FollowPath"),
        (CancelSpin, "Spin"),
        (CancelBackUp, "BackUp"),
        (CancelDriveOnHeading, "DriveOnHeading"),
        (CancelWait, "Wait"),
    ],
)
def test_cancelling_counts(flat: Flat, act: Act, kind: type[Skill], action: str) -> None:
    nav2 = Nav2Service()
    assert act(kind, flat(), nav2=nav2).status == "SUCCESS"
    assert nav2.cancels(action) == 1


def test_reinitialize_global_localization_forgets_the_place(flat: Flat, act: Act) -> None:
    world = flat(START)
    widths: list[float] = []

    def note(session: Any, world: Any) -> None:
        services = session.skill.services
        widths.append(float(services["localization"].covariance[0, 0]))

    assert act(ReinitializeGlobalLocalization, world, on_tick=note).status == "SUCCESS"
    assert widths[-1] > 0.5
