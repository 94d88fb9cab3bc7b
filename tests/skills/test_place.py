"""place: what is held ends upright on a spot, or the skill says why not."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.hand import rims, verification
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_skills.manipulation.scene.surroundings import SeenSpace
from momantu_skills.place import SEEN, Place

from momantu_bt.claim import Holding, SetDown
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import SupportPlane
from momantu_bt.testing import run_skill
from momantu_bt.testing.painting import Block, Round
from tests.skills.scenery.table import SceneOf, Tabletop

HAND_FROM_CAN = Transform((0.007, 0.0, 0.0))
"""Gripped from the side: upright while the hand is level."""


def plane(stamp: float = 0.0, height: float = 0.72) -> SupportPlane:
    outline = ((-0.4, -0.7), (0.4, -0.7), (0.4, 0.7), (-0.4, 0.7))
    return SupportPlane(Pose(Transform((0.9, 0.0, height)), "odom", stamp), outline)


Carrying = Callable[[], tuple[Tabletop, PlanningSceneService]]


def spots(*places: tuple[float, float], height: float = 0.72, stamp: float = 0.0) -> Any:
    return tuple(Pose(Transform((x, y, height)), "odom", stamp) for x, y in places)


@pytest.fixture
def holding(tabletop: type[Tabletop], scene_of: SceneOf) -> Carrying:
    """Fetch in the pose for carrying, with the can in its hand and a scene that knows it."""

    def build() -> tuple[Tabletop, PlanningSceneService]:
        robot = tabletop(pose="carry")
        thing = robot.detected()
        robot.hold(HAND_FROM_CAN)
        robot.advance(0.05)
        scene = scene_of(robot)
        scene.grasped(thing, HAND_FROM_CAN)
        scene.holding.last_contact = -math.inf
        return robot, scene

    return build


def place(robot: Any, scene: Any, where: Any = None, top: Any = None, **more: Any) -> Any:
    inputs = {"plane": top or plane(), "spots": where if where is not None else spots((0.7, 0.0))}
    services = {"planning_scene": scene}
    return run_skill(
        Place, robot=robot, inputs=inputs, services=services, frames=scene.frames, **more
    )


def arm_is_ready(robot: Tabletop) -> bool:
    """Whether the arm was taken to where it hides nothing."""
    ready, state = robot.description.named_poses["ready"], robot.state()
    arm = robot.description.groups["arm"].joints
    return all(abs(state.position(name) - ready[name]) < 0.05 for name in arm if name in ready)


@pytest.mark.parametrize("spot", [(0.65, -0.2), (0.8, 0.15)])
def test_the_can_stands_on_the_spot(holding: Carrying, spot: tuple[float, float]) -> None:
    robot, scene = holding()
    result = place(robot, scene, spots(spot))
    assert result.status == "SUCCESS", result.explain()
    assert np.linalg.norm(robot.can.position[:2] - spot) < 0.01
    assert robot.can.rotation[2, 2] > math.cos(math.radians(2))
    assert scene.held is None
    gap = np.linalg.norm(robot.odom_from_hand.position - robot.can.position)
    assert gap > 0.1


def test_contact_ends_the_lowering_when_the_surface_is_higher(holding: Carrying) -> None:
    robot, scene = holding()
    result = place(robot, scene, spots((0.7, 0.0), height=0.71), plane(height=0.71))
    assert result.status == "SUCCESS", result.explain()


def test_a_later_spot_serves_when_the_first_is_taken(holding: Carrying) -> None:
    robot, scene = holding()
    robot.others = [Block((0.1, 0.1, 0.2), (0.7, 0.0, 0.82))]
    result = place(robot, scene, spots((0.7, 0.0), (0.7, -0.25)))
    assert result.status == "SUCCESS", result.explain()
    assert np.linalg.norm(robot.can.position[:2] - (0.7, -0.25)) < 0.01


def test_nothing_held(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    assert place(robot, scene_of(robot)).code == "NOTHING_HELD"


def test_what_no_pick_has_reported_is_held_all_the_same(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(pose="carry")
    robot.hold(HAND_FROM_CAN)
    scene = scene_of(robot)
    for _ in range(10):
        robot.advance(0.05)
        scene.update(robot, robot.time)
    assert scene.held is None
    result = place(robot, scene)
    assert result.code == "HELD_UNKNOWN"
    assert "the fingers are 70 mm open" in result.failure.message
    assert result.failure.data["fingers"] > 0.0


def test_an_old_surface_is_stale(holding: Carrying) -> None:
    robot, scene = holding()
    assert place(robot, scene, top=plane(stamp=-100.0)).code == "STALE_POSE"


def test_a_surface_from_before_the_last_contact_is_stale(holding: Carrying) -> None:
    robot, scene = holding()
    scene.touched()
    assert place(robot, scene, top=plane(stamp=-1.0)).code == "STALE_POSE"


def test_spots_out_of_reach_are_no_place(holding: Carrying) -> None:
    robot, scene = holding()
    assert place(robot, scene, spots((1.25, 0.6))).code == "NO_PLACE_POSE"


def test_no_spots_are_no_place(holding: Carrying) -> None:
    robot, scene = holding()
    assert place(robot, scene, ()).code == "NO_PLACE_POSE"


def test_no_way_is_no_plan(holding: Carrying, monkeypatch: pytest.MonkeyPatch) -> None:
    from momantu_skills.manipulation.motion.planner import Planner

    robot, scene = holding()
    monkeypatch.setattr(Planner, "path", lambda *_: None)
    assert place(robot, scene).code == "NO_PLAN"


def test_a_surface_that_is_not_felt_is_no_contact(holding: Carrying) -> None:
    robot, scene = holding()
    robot.surface_felt = False
    result = place(robot, scene)
    assert result.code == "NO_CONTACT"
    assert scene.held is not None
    assert robot.can.position[2] - 0.065 > 0.72


def test_a_hand_that_feels_nothing_lets_go_just_above_the_surface(holding: Carrying) -> None:
    robot, scene = holding()
    seen: list[float] = []
    del robot.description.sensors["wrench"]

    def note(session: Any, world: Any) -> None:
        if robot.hand_from_can is not None:
            seen.append(robot.can.position[2] - 0.065)

    result = place(robot, scene, on_tick=note)
    assert result.status == "SUCCESS", result.explain()
    assert 0.72 + 0.003 < seen[-1] < 0.72 + 0.009
    assert scene.held is None


def test_what_falls_on_the_way_is_lost(holding: Carrying) -> None:
    robot, scene = holding()

    def drop(session: Any, world: Any) -> None:
        if robot.time > 1.5 and robot.hand_from_can is not None:
            robot.object_width = robot.hand_from_can = robot.can = None

    result = place(robot, scene, on_tick=drop)
    assert result.code == "LOST"
    assert "on the way" in result.failure.message


def test_what_is_gone_from_the_spot_is_lost(holding: Carrying) -> None:
    robot, scene = holding()
    robot.stays_hidden = True
    result = place(robot, scene)
    assert result.code == "LOST"
    assert "not where" in result.failure.message


@pytest.mark.parametrize("slipped", [-0.03, -0.018, 0.018, 0.03])
def test_what_slipped_in_the_hand_stands_a_little_beside(holding: Carrying, slipped: float) -> None:
    robot, scene = holding()
    robot.hold(HAND_FROM_CAN @ Transform((0.0, slipped, 0.0)))
    result = place(robot, scene)
    assert result.status == "SUCCESS", result.explain()
    claim = result.claim()
    assert isinstance(claim, SetDown)
    off = robot.can.position[:2] - (0.7, 0.0)
    assert np.linalg.norm(off) == pytest.approx(abs(slipped), abs=0.008)
    assert np.linalg.norm(claim.odom_from_object.position - robot.can.position) < SEEN


def test_what_stands_beside_all_along_is_not_what_was_set_down(holding: Carrying) -> None:
    robot, scene = holding()
    robot.others = [Round((0.7, 0.15, 0.72), 0.13, 0.035)]
    robot.stays_hidden = True
    assert place(robot, scene).code == "LOST"


def test_what_lies_there_has_toppled(holding: Carrying) -> None:
    robot, scene = holding()
    robot.topples = True
    assert place(robot, scene).code == "TOPPLED"


@pytest.mark.parametrize("actuator", ["arm", "gripper"])
def test_what_does_not_move_is_stuck(holding: Carrying, actuator: str) -> None:
    robot, scene = holding()
    robot.frozen.add(actuator)
    assert place(robot, scene).code == "ARM_STUCK"


@pytest.mark.parametrize("topples", [False, True])
def test_standing_there_is_claimed_of_the_spot_whether_said_or_denied(
    holding: Carrying, topples: bool
) -> None:
    robot, scene = holding()
    robot.topples = topples
    result = place(robot, scene)
    claim = result.claim()
    assert (result.code == "TOPPLED") is topples
    assert isinstance(claim, SetDown)
    assert np.linalg.norm(claim.odom_from_object.position - robot.can.position) < claim.tolerance
    assert claim.odom_from_object.position[2] == pytest.approx(0.72 + 0.065, abs=0.005)


def test_nothing_held_is_contradicted_by_something_held(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    assert place(robot, scene_of(robot)).claim() == Holding(True)


def test_what_never_got_to_a_spot_claims_nothing(holding: Carrying) -> None:
    robot, scene = holding()
    assert place(robot, scene, ()).claim() is None


def test_an_arm_that_hides_the_spot_is_taken_away_before_the_can_is_called_lost(
    holding: Carrying, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, scene = holding()
    judged, looked = verification.standing, []

    def hidden_at_first(*given: Any) -> str:
        looked.append(given)
        return "gone" if len(looked) == 1 else judged(*given)

    monkeypatch.setattr(verification, "standing", hidden_at_first)
    monkeypatch.setattr(verification, "beside", lambda *given: None)
    monkeypatch.setattr(SeenSpace, "hidden", lambda self, points, slack: np.ones(len(points)))
    result = place(robot, scene, spots((0.7, 0.0)))
    assert result.status == "SUCCESS", result.explain()
    assert len(looked) == 2
    assert arm_is_ready(robot)


def test_where_a_thing_held_by_its_rim_stands_is_looked_at_once_more(
    holding: Carrying, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, scene = holding()
    turned, looked = Transform((0.03, 0.0, 0.0)), []

    def little_at_first(points: Any, pose: Transform, *_: Any) -> Transform | None:
        looked.append(pose)
        return None if len(looked) == 1 else pose @ turned

    monkeypatch.setattr(rims, "held_by_rim", lambda held: True)
    monkeypatch.setattr(verification, "beside", little_at_first)
    result = place(robot, scene)
    assert result.status == "SUCCESS", result.explain()
    assert len(looked) == 2
    claim = result.claim()
    assert isinstance(claim, SetDown)
    assert claim.odom_from_object == looked[-1] @ turned
    assert arm_is_ready(robot)
