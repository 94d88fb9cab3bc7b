"""Localization finds the pose, says how sure it is, and repeats itself."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.config import LocalizationConfig, NavigationConfig
from momantu_skills.navigation.localize.confidence import is_localized, sigmas
from momantu_skills.navigation.localize.fit import scan_fit
from momantu_skills.navigation.localize.localizer import Localizer
from momantu_skills.navigation.localize.service import LocalizationService
from momantu_skills.navigation.map.fields import surface_distance
from momantu_skills.navigation.map.maps import GridMap, read_grid
from momantu_skills.navigation.map.sensing import SPREAD, Rays

from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import Failure
from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Pose2D, Transform, wrap_angle
from momantu_bt.messages import BaseVelocity, LaserScan
from momantu_bt.robot import Robot
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, run_skill, scripted_site


def _room() -> GridMap:
    """6 m x 4 m from (-3, -2), with a box in one corner: no two places look alike."""
    cells = np.zeros((80, 120), np.uint8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    cells[60:79, 95:119] = OCCUPIED
    return GridMap(cells, 0.05, (-3.0, -2.0))


ROOM = _room()
FIELD = surface_distance(ROOM.cells == OCCUPIED, ROOM.resolution, 0.5)


def _seen_from(pose: Pose2D, seed: int = 0, shorten: float = 0.0) -> Rays:
    """220 degrees of noisy beams by marching; `shorten`: share that something else stops."""
    random = np.random.default_rng(seed)
    angles = np.linspace(-1.9, 1.9, 200)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    turned = pose.yaw + angles
    steps = np.arange(0.0, 8.0, 0.01)
    x = pose.x + np.cos(turned)[:, None] * steps
    y = pose.y + np.sin(turned)[:, None] * steps
    row = np.clip(((y + 2.0) / 0.05).astype(int), 0, 79)
    column = np.clip(((x + 3.0) / 0.05).astype(int), 0, 119)
    ranges = steps[(ROOM.cells[row, column] == OCCUPIED).argmax(axis=1)]
    ranges = ranges + random.normal(0.0, 0.015, len(ranges))
    ranges[: int(shorten * len(ranges))] *= 0.6
    return Rays(np.zeros(2), ways, ranges, np.ones(len(ranges), bool))


POSES = st.builds(Pose2D, st.floats(-2, 1), st.floats(-1.3, 0.6), st.floats(-math.pi, math.pi))


def _error(localizer: Localizer, truth: Pose2D) -> tuple[float, float]:
    off = truth.inverse() @ localizer.estimate
    return math.hypot(off.x, off.y), abs(off.yaw)


@settings(max_examples=10)
@given(POSES, st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-0.25, 0.25))
def test_a_rough_start_is_mended(truth: Pose2D, dx: float, dy: float, turn: float) -> None:
    localizer = Localizer(ROOM, LocalizationConfig(), np.random.default_rng(1))
    localizer.reset(Pose2D(truth.x + dx, truth.y + dy, truth.yaw + turn), 0.15, 0.13)
    for k in range(15):
        localizer.jitter(0.006)
        localizer.observe(_seen_from(truth, seed=k))
    distance, angle = _error(localizer, truth)
    assert distance < 0.04
    assert angle < 0.02
    assert localizer.quality > 0.9


@settings(max_examples=4)
@given(POSES)
def test_from_nowhere_it_is_found_by_turning(truth: Pose2D) -> None:
    localizer = Localizer(ROOM, LocalizationConfig(), np.random.default_rng(2))
    localizer.spread()
    assert sigmas(localizer.covariance)[0] > 1.0
    turn = Pose2D(0.0, 0.0, 0.5)
    for k in range(16):
        localizer.observe(_seen_from(truth, seed=k))
        assert k > 2 or sigmas(localizer.covariance)[0] > 0.2
        truth = truth @ turn
        localizer.move(turn)
    localizer.observe(_seen_from(truth, seed=20))
    assert _error(localizer, truth)[0] < 0.05
    assert sigmas(localizer.covariance)[0] < 0.1


def test_a_third_of_the_view_taken_by_furniture_does_not_mislead() -> None:
    truth = Pose2D(-1.0, -0.5, 0.4)
    localizer = Localizer(ROOM, LocalizationConfig(), np.random.default_rng(3))
    localizer.reset(truth @ Pose2D(0.15, -0.1, 0.15), 0.15, 0.13)
    for k in range(15):
        localizer.jitter(0.006)
        localizer.observe(_seen_from(truth, seed=k, shorten=0.33))
    assert _error(localizer, truth)[0] < 0.05
    assert localizer.quality > 0.7


@given(POSES, st.floats(0.6, 2.0), st.floats(-math.pi, math.pi))
@settings(max_examples=30)
def test_the_fit_tells_the_right_pose_from_a_wrong_one(
    truth: Pose2D, away: float, turn: float
) -> None:
    rays = _seen_from(truth)
    wrong = Pose2D(truth.x - math.copysign(away, truth.x), truth.y, truth.yaw + turn)
    right = scan_fit(ROOM, FIELD, truth, rays)
    assert right > 0.9
    assert scan_fit(ROOM, FIELD, wrong, rays) < right


def test_a_scan_without_hits_says_nothing() -> None:
    blind = Rays(np.zeros(2), np.ones((5, 2)), np.full(5, 25.0), np.zeros(5, bool))
    localizer = Localizer(ROOM, LocalizationConfig(), np.random.default_rng(0))
    before = localizer.estimate
    localizer.observe(blind)
    assert localizer.quality == 0.0
    assert localizer.estimate == before


def test_same_seed_same_belief() -> None:
    ends = []
    for _ in range(2):
        localizer = Localizer(ROOM, LocalizationConfig(), np.random.default_rng(7))
        localizer.reset(Pose2D(0.0, 0.0, 0.0), 0.1, 0.1)
        for k in range(4):
            localizer.move(Pose2D(0.1, 0.0, 0.02))
            localizer.observe(_seen_from(Pose2D(0.1 * (k + 1), 0.0, 0.0), seed=k))
        ends.append((localizer.estimate, localizer.covariance.tobytes()))
    assert ends[0] == ends[1]


def test_odometry_alone_grows_less_sure() -> None:
    localizer = Localizer(ROOM, LocalizationConfig(), np.random.default_rng(0))
    localizer.reset(Pose2D(-2.0, 0.0, 0.0), 0.01, 0.01)
    before = sigmas(localizer.covariance)
    for _ in range(20):
        localizer.move(Pose2D(0.1, 0.0, 0.0))
    assert localizer.estimate.x == pytest.approx(0.0, abs=1e-3)
    spread = localizer._poses.std(axis=0)
    assert spread[0] > before[0]
    assert spread[2] > before[1]


def test_a_map_without_floor_is_refused() -> None:
    grid = GridMap(np.full((3, 3), OCCUPIED, np.uint8), 0.05, (0.0, 0.0))
    with pytest.raises(ValueError, match="no free cell"):
        Localizer(grid, LocalizationConfig(), np.random.default_rng(0))


def _scan(ranges: list[float]) -> LaserScan:
    return LaserScan(0.0, "laser", -0.2, 0.1, 0.05, 10.0, np.array(ranges))


def test_rays_of_a_laser_that_hangs_upside_down_are_mirrored() -> None:
    scan = _scan([1.0, 2.0, 3.0, 4.0, 10.0])
    upright = Rays.from_scan(scan, Transform((0.2, 0.0, 0.3)))
    hanging = Rays.from_scan(scan, Transform.from_rpy((0.2, 0.0, 0.3), (math.pi, 0.0, 0.0)))
    assert hanging.directions == pytest.approx(upright.directions * (1, -1), abs=1e-9)
    assert upright.hit.tolist() == [True] * 4 + [False]
    assert upright.points()[2] == pytest.approx((3.2, 0.0))


def test_rays_leave_out_what_is_no_measurement() -> None:
    rays = Rays.from_scan(_scan([0.01, math.nan, math.inf, 2.0, 3.0]), Transform())
    assert rays.hit.tolist() == [False, False, False, True, True]


def test_thinning_counts_what_is_near_no_more_than_what_is_far() -> None:
    angles = np.linspace(-1.0, 1.0, 400)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ranges = np.where(angles < 0.0, 0.5, 5.0)
    chosen = Rays(np.zeros(2), ways, ranges, np.ones(400, bool)).thinned(1000)
    near = np.hypot(*chosen.T) < 1.0
    assert near.sum() <= 0.5 / SPREAD * 3
    assert (~near).sum() > 2 * near.sum()


def test_unknown_tunables_are_named() -> None:
    assert configured(LocalizationConfig, {"particles": [4, 6]}, "localization").particles == (4, 6)
    with pytest.raises(ValueError, match="navigate has no tunable 'sped'; did you mean speed"):
        configured(NavigationConfig, {"sped": 1.0}, "navigate")


# the service, in the flat world


class _Wander(Skill):
    """Drive a curve for eight seconds."""

    uses = {"base"}

    def run(self, robot: Robot) -> Run:
        while self.clock.now() < 8.0:
            turn = 0.5 if self.clock.now() > 5.0 else 0.1
            robot.command("base", BaseVelocity(0.4, turn))
            yield "wander"


class _Circle(Skill):
    """Drive rounds of 0.7 m of radius, 15 m in all."""

    uses = {"base"}

    def run(self, robot: Robot) -> Run:
        while self.clock.now() < 50.0:
            robot.command("base", BaseVelocity(0.3, 0.45))
            yield "circle"


def _wandered(world: ScriptedWorld) -> tuple[LocalizationService, float]:
    service = LocalizationService()
    result = run_skill(_Wander, world=world, services={"localization": service})
    assert result.status == "SUCCESS", result.explain()
    return service, service.map_from_base.distance_to(world.robot.truth)  # type: ignore[attr-defined]


def test_the_service_keeps_up_with_drifting_odometry(flat) -> None:  # type: ignore[no-untyped-def]
    world = flat(Pose2D(-3.0, -1.0, 0.2), believed=Pose2D(-2.85, -1.1, 0.35), drift=0.08)
    service, error = _wandered(world)
    assert error < 0.04
    assert is_localized(service)
    published = service.published()
    assert set(published) == set(service.publishes)
    assert published["pose"] == service.map_from_base


def test_the_service_tells_the_frame_buffer(flat) -> None:  # type: ignore[no-untyped-def]
    world = flat(Pose2D(-3.0, -1.0, 0.2))
    seen = []

    class Ask(Skill):
        """Look once."""

        def run(self, robot: Robot) -> Run:
            seen.append(self.frames.lookup("map", "odom"))
            yield "ask"

    run_skill(Ask, world=world, services={"localization": LocalizationService()})
    assert Pose2D.from_transform(seen[0]).distance_to(world.robot.truth) < 0.2


def _no_scan(robot: ScriptedRobot) -> LaserScan:
    raise Failure("SENSOR_DEAD", "no scan comes")


@pytest.mark.parametrize("seed", range(4))
def test_without_a_map_it_says_where_it_is_in_a_frame_that_begins_with_it(
    flat: Any, seed: int
) -> None:
    """Longer than the scans of one submap; odometry alone is off by half a metre at times."""
    start = Pose2D(-2.5, -1.5 + 0.5 * seed, 0.2)
    world = flat(start, drift=0.08, seed=seed)
    world.site = replace(world.site, map_file=None, start=Pose2D(7.0, 7.0, 1.0))
    service = LocalizationService()
    result = run_skill(_Circle, world=world, services={"localization": service})
    assert result.status == "SUCCESS", result.explain()
    moved = world.site.start.inverse() @ service.map_from_base
    assert (start @ moved).distance_to(world.robot.truth) < 0.05
    assert abs(wrap_angle((start @ moved).yaw - world.robot.truth.yaw)) < 0.02
    assert is_localized(service)


def test_without_a_map_and_without_a_laser_odometry_alone_says_where_it_is() -> None:
    site = replace(scripted_site(), start=Pose2D(3.0, 1.0, math.pi / 2))
    service, robot = LocalizationService(), ScriptedRobot()
    robot.readings["laser"] = _no_scan
    result = run_skill(_Wander, robot=robot, site=site, services={"localization": service})
    assert result.status == "SUCCESS", result.explain()
    driven = Pose2D.from_transform(result.robot.state().odom_from_base)
    assert driven.x > 0.05
    assert service.map_from_base.distance_to(site.start @ driven) < 0.05
    service.spread()
    service.reset(Pose2D(0.0, 0.0, 0.0), 1.0, 1.0)
    assert is_localized(service)
    assert service.map_from_base.distance_to(site.start @ driven) < 0.05
    assert service.places == ()


def test_every_cell_of_the_flat_map_is_read_back(flat) -> None:  # type: ignore[no-untyped-def]
    path = flat().site.map_file
    assert isinstance(path, Path)
    grid = read_grid(path)
    assert grid.cells[grid.index(0.0, 0.0)] == FREE
    assert grid.cells[grid.index(3.9, 0.2)] == OCCUPIED
