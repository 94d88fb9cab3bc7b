"""navigate: gets there without touching anything, or says why not; each code is provoked."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from momantu_skills.navigate import Navigate
from momantu_skills.navigation.localize.service import LocalizationService

from momantu_bt.claim import BaseAt, BaseNear, Holding
from momantu_bt.geometry import Pose, Pose2D, Transform, wrap_angle
from momantu_bt.messages import BaseVelocity, DetectedObject
from momantu_bt.running.told import Told
from momantu_bt.service import HeldObject
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, small_robot
from momantu_bt.testing.skill_run import SkillResult, run_skill
from momantu_bt.world import Surface
from tests.skills.scenery.flat import Flat, FlatSceneOf
from tests.skills.scenery.table import SceneOf

Drive = Callable[..., SkillResult]
FRONT = Pose2D(3.0, 0.2, 0.0)
"""Before the desk of the flat world."""


@pytest.fixture
def drive(flat_scene: FlatSceneOf) -> Drive:
    """`drive(world, in_front_of=…)` with localization and a planning scene."""

    def run(world: ScriptedWorld, *, on_tick: Any = None, **inputs: Any) -> SkillResult:
        services = {"localization": LocalizationService(), "planning_scene": flat_scene(world)}
        return run_skill(
            Navigate, world=world, services=services, inputs=inputs, max_time=150.0, on_tick=on_tick
        )

    return run


def _off(world: Any, goal: Pose2D) -> tuple[float, float]:
    left = goal.inverse() @ world.robot.truth
    return math.hypot(left.x, left.y), abs(left.yaw)


def _arrived(result: SkillResult, world: Any, goal: Pose2D, slack: float = 0.04) -> None:
    """Within tolerance by the robot's belief, and nearly so in truth; untouched and at rest."""
    assert result.status == "SUCCESS", result.explain()
    distance, angle = _off(world, goal)
    assert distance < 0.05 + slack
    assert angle < 0.05 + slack
    assert world.robot.nearest > 0.02
    assert abs(world.robot.linear) < 0.02


@pytest.mark.parametrize("seed", range(3))
def test_from_random_starts_to_random_goals(flat: Flat, drive: Drive, seed: int) -> None:
    random = np.random.default_rng(seed)
    start = Pose2D(random.uniform(-3.2, 0.2), random.uniform(-1.5, 2.2), random.uniform(-3, 3))
    goal = Pose2D(random.uniform(1.8, 2.9), random.uniform(-2.2, 2.2), random.uniform(-3, 3))
    world = flat(start, believed=start @ Pose2D(0.15, -0.12, 0.15), seed=seed)
    _arrived(drive(world, goal=goal), world, goal)


def _unmapped(flat: Flat, start: Pose2D, **more: Any) -> ScriptedWorld:
    """The flat world, of which the robot is told nothing but that it starts at the origin."""
    world = flat(start, **{"drift": 0.0, **more})
    told = Told(None, charted=False).of(world.site)
    world.site = replace(told, places={"beyond": start.inverse() @ Pose2D(3.0, 2.3, 1.0)})
    return world


def test_without_a_map_it_finds_the_doorway_to_a_pose(flat: Flat, drive: Drive) -> None:
    start, goal = Pose2D(-2.0, -1.5, 2.5), Pose2D(2.4, -2.0, 0.5)
    world = _unmapped(flat, start)
    result = drive(world, goal=start.inverse() @ goal)
    _arrived(result, world, goal)
    assert result.claim() is None


def test_without_a_map_scans_make_up_for_odometry_that_drifts(flat: Flat, drive: Drive) -> None:
    """Odometry alone would end 0.3 m beside the goal."""
    start, goal = Pose2D(-2.0, -1.5, 2.5), Pose2D(2.4, -2.0, 0.5)
    world = _unmapped(flat, start, drift=0.06)
    _arrived(drive(world, goal=start.inverse() @ goal), world, goal)
    told = start @ Pose2D.from_transform(world.robot.state().odom_from_base)
    assert told.distance_to(world.robot.truth) > 0.3


def test_without_a_map_names_lie_in_odom(flat: Flat, drive: Drive) -> None:
    world = _unmapped(flat, Pose2D(-2.0, 0.0, 0.4))
    _arrived(drive(world, in_front_of="beyond"), world, Pose2D(3.0, 2.3, 1.0))


def test_without_a_map_it_goes_to_what_was_detected(flat: Flat, drive: Drive) -> None:
    start = Pose2D(-2.0, 0.0, 0.4)
    world = _unmapped(flat, start)
    there = (start.inverse().transform() @ Transform((3.75, 0.2, 0.8))).position
    result = drive(world, within_reach_of=Pose(Transform(there), "odom", 0.0))
    assert result.status == "SUCCESS", result.explain()
    assert math.dist((world.robot.truth.x, world.robot.truth.y), (3.75, 0.2)) < 1.0
    assert world.robot.nearest > 0.0


def test_without_a_map_a_closed_room_is_said_to_be_closed(flat: Flat, drive: Drive) -> None:
    start = Pose2D(-2.0, 0.0, 0.0)
    world = _unmapped(flat, start, hidden=[(0.9, 0.3, 1.1, 1.6)])
    result = drive(world, goal=start.inverse() @ Pose2D(2.4, -2.0, 0.0))
    assert result.code in ("PATH_BLOCKED", "NO_PROGRESS"), result.explain()
    assert world.robot.nearest > 0.0
    assert abs(world.robot.linear) < 0.02
    assert result.duration < 140.0


def test_without_a_map_a_goal_too_far_away_is_refused(flat: Flat, drive: Drive) -> None:
    world = _unmapped(flat, Pose2D(-2.0, 0.0, 0.0))
    result = drive(world, goal=Pose2D(300.0, 0.0, 0.0))
    assert result.code == "BAD_GOAL"
    assert "in reach without a map" in result.explain()


def test_in_front_of_a_surface_it_stands_square(flat: Flat, drive: Drive) -> None:
    world = flat()
    _arrived(drive(world, in_front_of="desk"), world, FRONT)


def test_in_front_of_a_place_is_the_place(flat: Flat, drive: Drive) -> None:
    world = flat()
    _arrived(drive(world, in_front_of="left"), world, world.site.places["left"])


def test_side_is_another_stand_that_looks_at_the_same(flat: Flat, drive: Drive) -> None:
    world = flat(FRONT)
    result = drive(world, in_front_of="desk", side=1)
    assert result.status == "SUCCESS", result.explain()
    assert world.robot.truth.distance_to(FRONT) > 0.3
    middle = world.robot.truth.inverse() @ Pose2D(3.9, 0.2, 0.0)
    assert abs(math.atan2(middle.y, middle.x)) < 0.12


@pytest.mark.parametrize("side", range(4))
def test_no_side_of_a_surface_is_looked_at_through_a_wall(
    flat: Flat, drive: Drive, side: int
) -> None:
    """The side that comes first, and is nearest to the robot, lies in the other room."""
    world = flat()
    bench = Surface(Pose2D(1.7, -1.2, 0.0), (0.7, 0.8), 0.7, (math.pi, 0.0, math.pi / 2))
    world.site = replace(world.site, surfaces={**world.site.surfaces, "bench": bench})
    result = drive(world, in_front_of="bench", side=side)
    assert result.status == "SUCCESS", result.explain()
    assert world.robot.truth.x > 1.3
    middle = world.robot.truth.inverse() @ bench.map_from_surface
    assert abs(math.atan2(middle.y, middle.x)) < 0.12


def test_within_reach_keeps_what_was_seen_in_odometry(flat: Flat, drive: Drive) -> None:
    """The pose is given in odom, which lies elsewhere than the map."""
    world = flat(FRONT)
    can = Pose2D(3.75, 0.5, 0.0)
    odom_from_map = world.robot.base @ world.robot.truth.inverse()
    seen = (odom_from_map @ can).transform(0.7)
    result = drive(world, within_reach_of=Pose(seen, "odom", 0.0))
    assert result.status == "SUCCESS", result.explain()
    here = world.robot.truth.inverse() @ can
    assert 0.45 < here.x < 0.95
    assert abs(here.y) < 0.3
    assert abs(world.robot.truth.yaw) < 0.1
    assert world.robot.nearest > 0.02


def test_what_the_map_does_not_know_is_driven_round(flat: Flat, drive: Drive) -> None:
    world = flat(hidden=[(-0.9, 0.1, -0.4, 0.6), (2.0, -0.4, 2.3, 0.5)])
    _arrived(drive(world, in_front_of="desk"), world, FRONT)


def test_a_desk_that_was_moved_towards_the_robot_is_not_touched(flat: Flat, drive: Drive) -> None:
    world = flat(desk=(3.5, -0.35, 4.1, 0.85))
    _arrived(drive(world, in_front_of="desk"), world, FRONT, slack=0.12)


@pytest.mark.parametrize(("lowest", "over"), [(0.6, False), (0.8, True)])
def test_only_what_hangs_higher_than_a_surface_reaches_over_it(
    flat: Flat, flat_scene: FlatSceneOf, lowest: float, over: bool
) -> None:
    """A load sticks out 25 cm before the base; the desk's top is at 0.7 m."""
    world, stick = flat(), 0.25
    scene = flat_scene(world)
    front = scene.outline[:, 0].max() + stick
    scene.load = (lowest, np.array([[front, -0.05], [front, 0.05]]))
    services = {"localization": LocalizationService(), "planning_scene": scene}
    inputs = {"within_reach_of": Pose(Pose2D(3.75, 0.2, 0.0).transform(0.7), "map", 0.0)}
    result = run_skill(Navigate, world=world, services=services, inputs=inputs, max_time=150.0)
    assert result.status == "SUCCESS", result.explain()
    tip = world.robot.truth.x + front
    assert (tip > 3.6) == over, f"the desk's edge is at 3.6 m, the load at {tip}"
    assert world.robot.nearest > 0.02


def test_at_the_goal_already_it_hardly_moves(flat: Flat, drive: Drive) -> None:
    world = flat(FRONT)
    result = drive(world, goal=FRONT)
    assert result.status == "SUCCESS", result.explain()
    assert result.duration < 3.0


def test_a_stand_straight_behind_is_backed_into(flat: Flat, drive: Drive) -> None:
    world = flat(FRONT)
    result = drive(world, goal=Pose2D(2.7, 0.2, 0.0))
    _arrived(result, world, Pose2D(2.7, 0.2, 0.0))
    assert result.phases[0:2] == ("back off", "settle"), result.phases
    assert result.duration < 6.0


def test_something_that_appears_in_the_doorway_is_waited_for(flat: Flat, drive: Drive) -> None:
    """Recovery looks again; meanwhile the way has become free."""
    world = flat()

    def person(session: Any, place: Any) -> None:
        standing = 2.0 < place.now() < 12.0
        place.robot.boxes = [b for b in place.robot.boxes if b != (0.9, 0.5, 1.2, 1.4)]
        if standing and place.robot.truth.x < 0.2:
            place.robot.boxes.append((0.9, 0.5, 1.2, 1.4))

    result = drive(world, in_front_of="desk", on_tick=person)
    _arrived(result, world, FRONT)


def test_the_base_brakes_when_halted(flat: Flat, flat_scene: FlatSceneOf) -> None:
    world = flat()
    services = {"localization": LocalizationService(), "planning_scene": flat_scene(world)}
    result = run_skill(
        Navigate, world=world, services=services, inputs={"in_front_of": "desk"}, max_time=4.0
    )
    assert result.status == "HALTED"
    assert world.robot.commands[-1][2] is None or world.robot.commands[-1][2] == BaseVelocity(0, 0)


def test_same_seed_same_drive(flat: Flat, drive: Drive) -> None:
    ends = []
    for _ in range(2):
        world = flat(believed=Pose2D(-1.9, 0.1, 0.1))
        drive(world, goal=Pose2D(-2.0, 1.2, 1.0))
        ends.append((world.robot.truth, world.now()))
    assert ends[0] == ends[1]


# each code


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        ({}, "it got none"),
        ({"in_front_of": "desk", "goal": FRONT}, "in_front_of, goal"),
        ({"in_front_of": "dusk"}, "no place 'dusk'; places: left, right, desk"),
        ({"goal": Pose2D(50.0, 0.0, 0.0)}, "not on the map, which spans x -4.5 to 6.5"),
        ({"goal": Pose2D(math.nan, 0.0, 0.0)}, "not on the map"),
        ({"goal": FRONT, "tolerance": 0.0}, "must be above 0"),
        ({"goal": FRONT, "side": -1}, "at least 0"),
    ],
)
def test_bad_goal(flat: Flat, drive: Drive, inputs: dict[str, Any], says: str) -> None:
    result = drive(flat(), **inputs)
    assert result.code == "BAD_GOAL", result.explain()
    assert says in result.failure.message  # type: ignore[union-attr]
    assert result.duration < 0.2


def test_goal_blocked(flat: Flat, drive: Drive) -> None:
    result = drive(flat(), goal=Pose2D(3.9, 0.2, 0.0), recovery=False)
    assert result.code == "GOAL_BLOCKED", result.explain()


def test_no_path(flat: Flat, drive: Drive) -> None:
    """The doorway is closed on the map itself."""
    world = flat(known=[(0.9, 0.3, 1.2, 1.6)])
    result = drive(world, in_front_of="desk", recovery=False)
    assert result.code == "NO_PATH", result.explain()


@pytest.mark.parametrize("recovery", [False, True])
def test_path_blocked_ends_in_bounded_time(flat: Flat, drive: Drive, recovery: bool) -> None:
    """Something that the map does not know closes the doorway."""
    world = flat(hidden=[(0.9, 0.3, 1.2, 1.6)])
    result = drive(world, in_front_of="desk", recovery=recovery)
    assert result.code == "PATH_BLOCKED", result.explain()
    assert result.duration < (60.0 if recovery else 20.0)
    assert world.robot.nearest > 0.02
    assert abs(world.robot.linear) < 0.02


def test_no_progress_when_the_base_does_not_move(flat: Flat, drive: Drive) -> None:
    world = flat()
    world.robot.frozen.add("base")
    result = drive(world, in_front_of="desk", recovery=False)
    assert result.code == "NO_PROGRESS", result.explain()
    assert result.duration < 20.0


def test_not_localized(flat: Flat, drive: Drive) -> None:
    """Told to be in a cupboard's corner of the other room, the scans fit nothing near."""
    world = flat(Pose2D(-2.0, 0.0, 0.0), believed=Pose2D(5.4, -2.4, 2.0))
    result = drive(world, in_front_of="desk")
    assert result.code == "NOT_LOCALIZED", result.explain()
    assert world.robot.truth == Pose2D(-2.0, 0.0, 0.0)


def test_a_pose_in_the_open_is_faced_at_best_reach(flat: Flat, drive: Drive) -> None:
    world = flat(Pose2D(-2.0, 0.0, 0.0))
    spot = Pose(Transform((-0.5, 0.0, 0.3)), "map", 0.0)
    result = drive(world, within_reach_of=spot)
    assert result.status == "SUCCESS", result.explain()
    here = world.robot.truth.inverse() @ Pose2D(-0.5, 0.0, 0.0)
    assert math.hypot(here.x, here.y) == pytest.approx(0.7, abs=0.1)
    assert abs(wrap_angle(math.atan2(here.y, here.x))) < 0.15


# what it claims


def _is_at(claim: Any, world: Any) -> bool:
    assert isinstance(claim, BaseAt)
    off = claim.map_from_base.inverse() @ world.robot.truth
    return math.hypot(off.x, off.y) <= claim.tolerance and abs(off.yaw) <= claim.turn_tolerance


def test_arrival_is_claimed_of_the_stand_within_the_tolerances(flat: Flat, drive: Drive) -> None:
    world = flat(FRONT @ Pose2D(-0.4, 0.0, 0.0))
    claim = drive(world, in_front_of="desk").claim()
    assert _is_at(claim, world)
    assert isinstance(claim, BaseAt)
    assert claim.map_from_base.distance_to(FRONT) < 0.01
    assert 0.05 < claim.tolerance < 0.15


def test_a_stand_within_reach_is_claimed_of_what_is_reached_for(flat: Flat, drive: Drive) -> None:
    world = flat(FRONT)
    can = Pose2D(3.75, 0.5, 0.0)
    odom_from_map = world.robot.base @ world.robot.truth.inverse()
    seen = (odom_from_map @ can).transform(0.7)
    claim = drive(world, within_reach_of=Pose(seen, "odom", 0.0)).claim()
    assert isinstance(claim, BaseNear)
    assert claim.odom_point == pytest.approx(tuple(seen.position[:2]))
    assert world.robot.truth.distance_to(can) < claim.distance


def test_no_progress_would_be_a_false_alarm_on_the_stand(flat: Flat, drive: Drive) -> None:
    world = flat()
    world.robot.frozen.add("base")
    result = drive(world, in_front_of="desk", recovery=False)
    assert result.code == "NO_PROGRESS"
    assert not _is_at(result.claim(), world)
    world.robot.truth = FRONT
    assert _is_at(result.claim(), world)


def test_without_a_stand_nothing_is_claimed(flat: Flat, drive: Drive) -> None:
    assert drive(flat(), in_front_of="dusk").claim() is None
    assert drive(flat(), goal=Pose2D(3.9, 0.2, 0.0), recovery=False).claim() is None


def test_it_does_not_drive_with_an_arm_stretched_out_that_does_not_fold(
    stretched_out: ScriptedRobot, scene_of: SceneOf
) -> None:
    scene = scene_of(stretched_out)
    services = {"localization": object(), "planning_scene": scene}
    result = run_skill(
        Navigate,
        robot=stretched_out,
        inputs={"in_front_of": "table_a"},
        services=services,
        frames=scene.frames,
    )
    assert result.code == "ARM_STUCK", result.explain()
    assert all(actuator != "base" for _, actuator, goal in stretched_out.commands if goal)


def test_a_camera_that_nothing_turns_still_shows_what_the_laser_does_not(
    flat: Flat, drive: Drive
) -> None:
    small = small_robot()
    camera = small.sensors["camera"].model_copy(update={"carrier": None})
    fixed = small.model_copy(update={"sensors": {**small.sensors, "camera": camera}})
    world = flat(description=fixed)
    pictures, blind = [], world.robot.readings["camera"]

    def picture(robot: ScriptedRobot) -> Any:
        pictures.append(robot.time)
        return blind(robot)

    world.robot.readings["camera"] = picture
    _arrived(drive(world, goal=Pose2D(0.0, 1.0, 0.0)), world, Pose2D(0.0, 1.0, 0.0))
    assert len(pictures) >= 2
    assert {actuator for _, actuator, _ in world.robot.commands} == {"base"}


LOAD = HeldObject(
    DetectedObject("can", Pose(Transform(), "odom", 0.0), (0.07, 0.07, 0.13), "cylinder", 1.0, 0.0),
    Transform(),
)


def test_it_stops_where_the_hand_loses_its_load_and_keeps_off_where_that_may_lie(
    flat: Flat, flat_scene: FlatSceneOf
) -> None:
    """Neither laser nor camera shows what lies on the floor here."""
    world, goal = flat(Pose2D(-3.0, 1.0, 0.0)), Pose2D(0.0, 1.0, 0.0)
    scene = flat_scene(world)
    scene.held, least = LOAD, [math.inf]

    def lose(session: Any, place: Any) -> None:
        base = place.robot.truth
        if scene.held is LOAD and base.x > -2.0:
            scene.held = None
            x, y = np.meshgrid(np.arange(0.9, 1.3, 0.05), np.arange(-0.2, 0.2, 0.05))
            scene.low_things = base.apply(np.column_stack([x.ravel(), y.ravel()]))
        if len(scene.low_things):
            own = base.inverse().apply(scene.low_things)
            least[0] = min(least[0], float(np.linalg.norm(own, axis=1).min()))

    def go() -> SkillResult:
        inputs = {"goal": goal}
        services = {"localization": LocalizationService(), "planning_scene": scene}
        return run_skill(
            Navigate, world=world, services=services, inputs=inputs, max_time=90.0, on_tick=lose
        )

    result = go()
    assert result.code == "LOAD_LOST", result.explain()
    assert abs(world.robot.linear) < 0.02
    assert world.robot.truth.x < -1.2
    assert result.claim() == Holding(True)
    world = flat(world.robot.truth)
    _arrived(go(), world, goal)
    assert least[0] > 0.25


def test_a_load_that_is_kept_does_not_matter(flat: Flat, flat_scene: FlatSceneOf) -> None:
    world, goal = flat(), Pose2D(0.0, 1.0, 0.0)
    scene = flat_scene(world)
    scene.held = LOAD
    services = {"localization": LocalizationService(), "planning_scene": scene}
    result = run_skill(Navigate, world=world, services=services, inputs={"goal": goal})
    _arrived(result, world, goal)
