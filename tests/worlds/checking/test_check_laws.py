"""Laws of the checks: what is wrong is measured, and nothing is wrong once the cure is taken."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.checking.access import places, start, surfaces
from momantu_worlds.checking.goals import RIM_LEAST
from momantu_worlds.checking.legible import light_on
from momantu_worlds.checking.measures import Measures
from momantu_worlds.checking.overlaps import TOUCHING, overlaps
from momantu_worlds.checking.run import CHECKS
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.checking.upright import TIPPING, upright
from momantu_worlds.scenes.catalogue.objects import Thing
from momantu_worlds.scenes.geometry.bodies import (
    Body,
    Box,
    Cylinder,
    Gap,
    Part,
    Picture,
    PointLight,
)
from momantu_worlds.scenes.geometry.solids import FLUSH

from momantu_bt.findings import FindingAtKeys
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.robot_parts import CameraSensor, Exposure
from tests.worlds.checking.test_checks import (
    BODIES,
    EPISODE,
    HEIGHT,
    PIXELS,
    ROBOT,
    all_codes,
    can,
    changed,
    table,
    tag,
    wall,
)

SIZE = st.floats(0.1, 0.5)
YAW = st.floats(-math.pi, math.pi)
HAIR = 1e-4
"""m; how near to a threshold nothing is claimed."""


def remarks(scenario: Scenario, code: str) -> list[FindingAtKeys]:
    return [r for check in SPEAKS.get(code, CHECKS) for r in check(scenario) if r.code == code]


SPEAKS = {
    "overlap": [overlaps],
    "in-floor": [overlaps],
    "in-the-air": [upright],
    "over-the-edge": [upright],
    "start-in-collision": [start],
    "place-blocked": [places],
    "surface-height": [surfaces],
}
"""The check that says it, where many episodes are tried."""


def block(name: str, pose: Transform, size: tuple[float, float, float], **fields: bool) -> Body:
    return Body(name, "crate", pose, (Part(Box(size)),), **fields)


@given(
    YAW, st.tuples(SIZE, SIZE, SIZE), st.tuples(SIZE, SIZE, SIZE), st.floats(-0.05, 0.08),
    st.booleans(), st.booleans(),
)  # fmt: skip
@settings(max_examples=25)
def test_an_overlap_is_as_deep_as_one_body_was_pushed_into_the_other(
    yaw: float,
    first: tuple[float, float, float],
    second: tuple[float, float, float],
    depth: float,
    fixed: bool,
    other_fixed: bool,
) -> None:
    at = Transform.from_rpy((1.5, -1.5, first[2] / 2), (0, 0, yaw))
    beside = at @ Transform(((first[0] + second[0]) / 2 - depth, 0, (second[2] - first[2]) / 2))
    found = remarks(
        changed(
            block("one", at, first, static=fixed), block("two", beside, second, static=other_fixed)
        ),
        "overlap",
    )
    if abs(depth - TOUCHING) < HAIR:
        return
    assert bool(found) == (depth > TOUCHING)
    for remark in found:
        assert remark.amount == pytest.approx(depth, abs=HAIR)
        assert remark.severity.label == ("warning" if fixed and other_fixed else "error")
        # what is loose is to blame
        blamed = remark.about[0]
        assert {"one": fixed, "two": other_fixed}[blamed] == (fixed and other_fixed)


@given(st.floats(-0.03, 0.3), YAW, st.tuples(SIZE, SIZE, SIZE))
@settings(max_examples=25)
def test_what_is_loose_hangs_in_the_air_by_as_much_as_it_was_lifted(
    lift: float, yaw: float, size: tuple[float, float, float]
) -> None:
    pose = Transform.from_rpy((-1.5, -1.5, size[2] / 2 + lift), (0, 0, yaw))
    scenario = changed(block("box", pose, size, static=False))
    if abs(lift - FLUSH) > HAIR:
        air = remarks(scenario, "in-the-air")
        assert [r.amount for r in air] == pytest.approx([lift] if lift > FLUSH else [], abs=HAIR)
    if abs(-lift - TOUCHING) > HAIR:
        sunk = remarks(scenario, "in-floor")
        assert [r.amount for r in sunk] == pytest.approx(
            [-lift] if -lift > TOUCHING else [], abs=HAIR
        )
    fixed = changed(block("box", pose, size, static=True))
    assert remarks(fixed, "in-the-air") == []
    assert {r.severity.label for r in remarks(fixed, "in-floor")} <= {"warning"}


@given(st.floats(-0.07, 0.07), st.sampled_from([0.0, math.pi / 2, math.pi, -math.pi / 2]))
@settings(max_examples=20)
def test_what_stands_over_an_edge_tips_once_its_middle_is_beyond_it(
    beyond: float, turn: float
) -> None:
    """A bar 16 cm long across each of the four edges of the table."""
    way = np.array([math.cos(turn), math.sin(turn)])
    x, y = np.array([2.0, 2.0]) + (0.4 + beyond) * way
    pose = Transform.from_rpy((x, y, HEIGHT + 0.03), (0, 0, turn))
    bar = block("bar", pose, (0.16, 0.04, 0.06), static=False)
    found = [(r.code, r.amount) for r in upright(changed(bar))]
    if beyond < -HAIR:
        assert found == []
    if beyond > 2 * TIPPING:
        assert found == [("over-the-edge", pytest.approx(beyond, abs=TIPPING))]


@pytest.mark.parametrize(("aside", "codes"), [(0.0, []), (0.1, []), (0.2, ["over-the-edge"])])
def test_a_tray_may_stand_on_a_narrow_foot_below_its_middle(aside: float, codes: list[str]) -> None:
    foot = block("foot", Transform((1.5, -2.0, 0.25)), (0.3, 0.3, 0.5), static=True)
    tray = block("tray", Transform((1.5 + aside, -2.0, 0.51)), (0.8, 0.5, 0.02), static=False)
    assert [remark.code for remark in upright(changed(foot, tray))] == codes


@given(YAW, st.floats(0.02, 0.3), st.floats(0.02, 0.3))
@settings(max_examples=15)
def test_a_hand_takes_an_item_across_its_narrow_side(yaw: float, long: float, wide: float) -> None:
    part = Part(Box((long, wide, 0.12)))
    pose = Transform.from_rpy((-2.0, 1.75, HEIGHT + 0.06), (0, 0, yaw))
    item = Body("can", "box", pose, (part,), static=False, mass=0.3)
    found = remarks(changed(item), "item-too-wide")
    narrow = min(long, wide)
    if abs(narrow - ROBOT.max_width) > 0.004:  # it is measured in 90 directions
        assert bool(found) == (narrow > ROBOT.max_width)
    for remark in found:
        assert narrow - 1e-9 <= remark.amount <= narrow + 0.02 * max(long, wide)


@given(st.floats(0.11, 0.18), st.floats(0.03, 0.08))
@settings(max_examples=10)
def test_a_hand_takes_a_bowl_by_its_rim_if_it_is_high_enough(wide: float, high: float) -> None:
    bowl = Thing("bowl", (wide, wide, high), 0.3, (0.5, 0.5, 0.5))
    pose = Transform((-2.0, 1.75, HEIGHT))
    item = Body("can", "bowl", pose, bowl.parts(), static=False, mass=0.3)
    if abs(high - RIM_LEAST) > 1e-3:
        assert bool(remarks(changed(item), "item-too-wide")) == (high < RIM_LEAST)


@given(st.floats(-40, 40), st.floats(-40, 40), st.sampled_from([0, 1, 2, 3]))
@settings(max_examples=3)
def test_where_a_world_lies_on_the_map_makes_no_difference(x: float, y: float, turns: int) -> None:
    moved = Transform.from_rpy((x, y, 0.0), (0, 0, turns * math.pi / 2))

    def flat(pose: Pose2D) -> Pose2D:
        at = moved @ pose.transform()
        return Pose2D(float(at.position[0]), float(at.position[1]), pose.yaw + turns * math.pi / 2)

    def everywhere(scenario: Scenario) -> Scenario:
        episode = scenario.episode
        site = replace(
            episode.site,
            places={name: flat(pose) for name, pose in episode.site.places.items()},
            surfaces={
                name: replace(surface, map_from_surface=flat(surface.map_from_surface))
                for name, surface in episode.site.surfaces.items()
            },
        )
        bodies = tuple(replace(b, map_from_body=moved @ b.map_from_body) for b in episode.bodies)
        doorways = {
            name: replace(gap, at=tuple(moved.apply(np.array([*gap.at, 0.0]))[:2].tolist()))
            for name, gap in episode.doorways.items()
        }
        return Scenario(
            replace(
                episode, bodies=bodies, site=site, start=flat(episode.start), doorways=doorways
            ),
            scenario.robot,
            scenario.place,
        )

    assert all_codes(everywhere(changed())) == []
    wrong = changed(can("other", -2.03, 1.76), wall("wall_middle_south", 0.0, -1.4, 0.1, 3.0))
    assert all_codes(everywhere(wrong)) == all_codes(wrong)


def with_door(width: float) -> Scenario:
    """The wall's southern piece ends so that the door is that wide, around its own middle."""
    end = 0.5 - width
    piece = wall("wall_middle_south", 0.0, (end - 3.0) / 2, 0.1, end + 3.0)
    return changed(piece, doorways={"door": Gap((0.0, 0.5 - width / 2), width / 2)})


def test_a_door_is_wide_enough_from_the_robots_width_on_and_the_cure_says_so() -> None:
    widths = [0.2, 0.3, 0.4, 0.45, 0.55, 0.65, 0.8]
    narrow = [bool(remarks(with_door(width), "door-narrow")) for width in widths]
    assert narrow == [True, True, True, True, False, False, False]
    (remark,) = remarks(with_door(0.3), "door-narrow")
    assert remark.amount == pytest.approx(2 * ROBOT.half_width - 0.3, abs=0.03)
    (centimetres,) = re.findall(r"at least (\d+) cm", remark.hint)
    assert all_codes(with_door(int(centimetres) / 100)) == []


@given(st.floats(0.05, 0.6))
@settings(max_examples=20)
def test_a_place_needs_half_of_the_robots_width_around_it(room: float) -> None:
    """The western wall ends at x = -2.95."""
    site = replace(EPISODE.site, places={"there": Pose2D(-2.95 + room, -2.0, 0.0)})
    found = remarks(changed(site=site), "place-blocked")
    if abs(room - ROBOT.half_width) > 0.04:
        assert bool(found) == (room < ROBOT.half_width)
    for remark in found:
        assert "wall_west" in remark.message
        assert -remark.amount == pytest.approx(room, abs=0.03)


@given(st.floats(0.0, 0.24), st.sampled_from([0.0, math.pi / 2, math.pi]))
@settings(max_examples=20)
def test_a_start_is_as_deep_in_a_wall_as_the_base_reaches_into_it(room: float, yaw: float) -> None:
    half = 0.25 if yaw == math.pi / 2 else 0.3
    found = remarks(changed(start=Pose2D(-2.95 + room, -2.0, yaw)), "start-in-collision")
    depth = half - room
    if abs(depth - TOUCHING) > HAIR:
        assert [r.amount for r in found] == pytest.approx(
            [depth] if depth > TOUCHING else [], abs=HAIR
        )


@pytest.mark.parametrize("height", [0.02, 1.3, 2.0])
def test_a_table_as_high_as_the_cure_says_is_worked_at(height: float) -> None:
    scenario = changed(table("b", 2.0, 2.0, height), tag(Transform((2.0, 1.85, height + 0.0005))))
    (remark,) = remarks(scenario, "surface-height")
    low, high = (float(h) for h in re.findall(r"\d+\.\d+", remark.hint))
    for good in (low, (low + high) / 2, high):
        told = changed(table("b", 2.0, 2.0, good), tag(Transform((2.0, 1.85, good + 0.0005))))
        assert remarks(told, "surface-height") == []


@given(st.integers(0, 3), st.integers(0, len(BODIES) - 1))
@settings(max_examples=4)
def test_what_is_found_does_not_hang_on_the_order_of_the_bodies(turn: int, swap: int) -> None:
    wrong = changed(can("other", -2.03, 1.76), can("third", 2.0, 2.2, HEIGHT + 0.04))
    bodies = list(wrong.episode.bodies)
    bodies[0], bodies[swap] = bodies[swap], bodies[0]
    bodies = bodies[turn:] + bodies[:turn]
    again = Scenario(replace(wrong.episode, bodies=tuple(bodies)), ROBOT, wrong.place)

    def plain(scenario: Scenario) -> set[tuple[str, frozenset[str]]]:
        return {(code, frozenset(about)) for code, about in all_codes(scenario)}

    assert plain(again) == plain(wrong)


def test_what_an_episode_adds_may_stand_on_a_place_but_not_what_is_known() -> None:
    at = Transform((1.5, -1.0, 0.2))
    crate = Part(Cylinder(0.1, 0.4))
    assert remarks(changed(Body("extra_plant_0", "plant", at, (crate,))), "place-blocked") == []
    (remark,) = remarks(changed(Body("plant", "plant", at, (crate,))), "place-blocked")
    assert "in plant" in remark.message


def test_without_a_goal_nothing_is_demanded_of_the_item() -> None:
    wide = can("can", -2.0, 1.75, radius=0.09)
    assert remarks(changed(wide), "item-too-wide")
    assert all_codes(changed(wide, goals=())) == []


def test_a_robot_without_a_camera_is_not_asked_about_tags() -> None:
    hidden = tag(Transform((2.0, 1.85, 0.4)))
    assert remarks(changed(hidden), "tag-unseen")
    assert remarks(changed(hidden, robot=replace(ROBOT, eyes=())), "tag-unseen") == []


def sighted(**exposure: float) -> Measures:
    """The robot with a camera of 640 x 480 pixels."""
    camera = CameraSensor(
        frame="eye",
        horizontal_fov=1.05,
        min_depth=0.3,
        max_depth=4.0,
        exposure=Exposure(**exposure),
    )
    return replace(ROBOT, camera=camera)


def lit(light: float) -> dict[str, tuple[float, float, float]]:
    return {"ambient": (light, light, light)}


def test_a_tag_in_the_dark_is_told_and_light_or_a_longer_exposure_cures_it() -> None:
    (remark,) = remarks(changed(robot=sighted(), **lit(1e-4)), "tag-unseen")
    assert "too dark there from everywhere: the light on it is 0.0001" in remark.message
    assert "longer exposure" in remark.hint
    assert remarks(changed(robot=sighted(), **lit(0.002)), "tag-unseen") == []
    patient = sighted(longest=0.3)
    assert remarks(changed(robot=patient, **lit(1e-4)), "tag-unseen") == []


def test_a_lamp_lights_the_tag_that_it_shines_on_and_not_one_that_faces_away() -> None:
    up, at = np.array([0.0, 0.0, 1.0]), np.array([2.0, 1.85, HEIGHT])
    lamp = PointLight((2.0, 1.85, HEIGHT + 2.0), (4.0, 4.0, 4.0))
    episode = changed(lamps=(lamp,), **lit(0.0)).episode
    assert light_on(episode, at, up) == pytest.approx(1.0 / math.pi)
    assert light_on(episode, at, -up) == 0.0


@pytest.mark.parametrize(("edge", "codes"), [(0.15, []), (0.006, ["tag-unseen"])])
def test_a_tag_smaller_than_the_cameras_pixels_is_told(edge: float, codes: list[str]) -> None:
    paper = Part(Picture((edge, edge), PIXELS), collision=False)
    small = Body("tag", "tag", Transform((2.0, 1.85, HEIGHT + 0.0005)), (paper,))
    found = remarks(changed(small, robot=sighted()), "tag-unseen")
    assert [each.code for each in found] == codes
    assert all("it is too small from" in each.message for each in found)
