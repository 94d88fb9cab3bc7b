"""The referee: each demand, violated alone, costs the success and is named."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import pytest
from momantu_worlds.sapien.build.truth import JointSpeed
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Episode, Goal, Part
from momantu_worlds.scenes.referee.demand import tilt
from momantu_worlds.scenes.referee.hand import Hand
from momantu_worlds.scenes.referee.referee import Referee

from momantu_bt.geometry import Array, Pose2D, Transform, quaternion_from_axis_angle
from momantu_bt.world import Demanded, Site, Verdict
from tests.worlds.origins import with_foot

TABLE_TOP = 0.5
HAND = Hand("gripper_link", frozenset({"left_finger", "right_finger"}), frozenset({"elbow"}))
TICK = 0.05


@dataclass(frozen=True)
class Touch:
    first: str
    second: str
    force: float = 4.0


@dataclass
class FakeTruth:
    """Ground truth that a test writes down."""

    poses: dict[str, Transform]
    touches: list[Touch]
    gripper: Transform = field(default_factory=lambda: Transform((0.3, 0, 0.8)))
    robot_links: frozenset[str] = frozenset({"gripper_link", "base_link"})
    watching: bool = False

    def pose(self, body: str) -> Transform:
        return self.poses[body]

    def link(self, name: str) -> Transform:
        assert name == "gripper_link"
        return self.gripper

    def base_speed(self) -> tuple[float, float]:
        return 0.0, 0.0

    def joint_speeds(self) -> dict[str, JointSpeed]:
        return {}

    def height_below(self, body: str, points: Array) -> tuple[float, str]:
        return float(points[:, 2].min()) - TABLE_TOP, "table_b"

    def watch_contacts(self) -> None:
        self.watching = True

    def contacts(self) -> list[Touch]:
        assert self.watching
        return self.touches


def body(name: str, part: Part, x: float, y: float, z: float, *, static: bool = False) -> Body:
    return Body(name, name, Transform((x, y, z)), (part,), static=static, mass=0.3)


TOP = Part(Box((0.8, 1.2, 0.04)), Transform((0, 0, TABLE_TOP - 0.02)))
CAN = Part(Cylinder(0.035, 0.13), Transform((0, 0, 0.065)))
GOAL = Goal(
    item="can",
    support="table_b",
    marker="tag",
    max_tilt=math.radians(5),
    max_distance=0.4,
    still_for=1.0,
    min_gripper_distance=0.1,
    max_others_tilt=math.radians(30),
    max_others_shift=0.1,
    max_force=150.0,
)


def episode() -> Episode:
    bodies = (
        body("table_b", TOP, 0, 0, 0, static=True),
        body("tag", Part(Box((0.1, 0.1, 0.001))), 0.1, 0.1, TABLE_TOP, static=True),
        body("can", CAN, 5, 5, 0.7),
        body("mug", CAN, -0.2, -0.3, TABLE_TOP),
    )
    return Episode("test", 0, bodies, Pose2D(0, 0), (0, 0, 0), (), (), Site("test"), (GOAL,))


def good_truth() -> FakeTruth:
    """All demands met: the can stands on the table beside the tag, the hand is away."""
    poses = {b.name: b.map_from_body for b in episode().bodies}
    poses["can"] = Transform((0.1, -0.1, TABLE_TOP))
    return FakeTruth(poses, [Touch("can", "table_b"), Touch("mug", "table_b")])


def watch(truth: FakeTruth, seconds: float = 1.5) -> Referee:
    referee = Referee(episode(), truth, HAND)
    for tick in range(1, round(seconds / TICK) + 1):
        referee.observe(tick * TICK)
    return referee


def tilted(pose: Transform, degrees: float) -> Transform:
    return Transform(pose.position, quaternion_from_axis_angle((1, 0, 0), math.radians(degrees)))


def test_all_demands_met_is_success_with_the_numbers_behind_it():
    verdict = watch(good_truth()).verdict()
    assert verdict.success
    assert verdict.unmet == ()
    assert verdict.measures["distance"] == pytest.approx(0.2)
    assert verdict.measures["force"] == 0.0


def put(name: str, *, dx: float = 0, dy: float = 0, dz: float = 0, degrees: float = 0):
    def change(truth: FakeTruth) -> None:
        pose = truth.poses[name]
        x, y, z = pose.position
        truth.poses[name] = tilted(Transform((x + dx, y + dy, z + dz)), degrees)

    return change


def touch(*touches: Touch):
    def change(truth: FakeTruth) -> None:
        truth.touches += touches

    return change


def no_table(truth: FakeTruth) -> None:
    truth.touches = [Touch("can", "mug")]


def hand_near(truth: FakeTruth) -> None:
    x, y, z = truth.poses["can"].position
    truth.gripper = Transform((x + 0.035 + 0.09, y, z + 0.06))


VIOLATIONS = [
    (put("can", degrees=5.5), "can is tilted 5.5 deg, more than 5.0 deg"),
    (put("can", dz=0.01), "can is 0.010 m above the top of table_b"),
    (put("can", dx=0.27), "the base of can is not whole on the top of table_b"),
    (put("can", dx=-0.37, dy=0.02), "can is 0.41 m from tag, more than 0.40 m"),
    (no_table, "can does not touch table_b"),
    (touch(Touch("can", "mug")), "can also touches mug"),
    (touch(Touch("gripper_link", "can")), "can also touches gripper_link"),
    (hand_near, "the gripper is 0.09 m from can, not more than 0.10 m"),
    (put("mug", degrees=31), "mug was tilted by 31.0 deg"),
    (put("mug", dx=0.08, dy=0.08), "mug was moved by 0.11 m"),
    (
        touch(Touch("base_link", "table_b", 151.0)),
        "the robot pushed with 151 N (base_link on table_b), more than 150 N",
    ),
]


@pytest.mark.parametrize(("violate", "sentence"), VIOLATIONS, ids=[s for _, s in VIOLATIONS])
def test_a_violated_demand_is_named(violate, sentence):
    truth = good_truth()
    violate(truth)
    verdict = watch(truth).verdict()
    assert not verdict.success
    assert sentence in verdict.unmet


ALLOWED = [
    put("can", degrees=4.5),
    put("can", dx=0.26),
    put("mug", degrees=29),
    put("mug", dx=0.09),
    touch(Touch("base_link", "table_b", 149.0)),
    touch(Touch("base_link", "gripper_link", 500.0)),
]


@pytest.mark.parametrize("change", ALLOWED)
def test_what_is_just_allowed_is_success(change):
    truth = good_truth()
    change(truth)
    verdict = watch(truth).verdict()
    assert verdict.success, verdict.unmet


def test_squeezing_the_item_hard_is_no_bump():
    truth = good_truth()
    referee = Referee(episode(), truth, HAND)
    truth.touches = [Touch("gripper_link", "can", 400.0), Touch("can", "table_b")]
    referee.observe(TICK)
    assert referee.verdict().measures["force"] == 0.0


def test_the_largest_force_has_its_bodies_whatever_it_is():
    truth = good_truth()
    referee = Referee(episode(), truth, HAND)
    for force, link in ((20.0, "base_link"), (35.0, "gripper_link"), (5.0, "base_link")):
        truth.touches = [Touch(link, "table_b", force)]
        referee.observe(TICK)
    verdict = referee.verdict()
    assert verdict.measures["force"] == 35.0
    assert verdict.causes == {"force": "gripper_link on table_b"}


def test_still_counts_from_the_last_move():
    truth = good_truth()
    referee = watch(truth, 1.0)
    put("can", dx=0.003)(truth)
    for tick in range(21, 36):
        referee.observe(tick * TICK)
    verdict = referee.verdict()
    assert verdict.measures["still"] == pytest.approx(0.7)
    assert "can has been still for 0.70 s, less than 1.00 s" in verdict.unmet
    for tick in range(36, 42):
        referee.observe(tick * TICK)
    assert referee.verdict().success


def test_a_slow_slide_is_not_still():
    truth = good_truth()
    referee = Referee(episode(), truth, HAND)
    for tick in range(1, 41):
        put("can", dx=0.0002)(truth)  # 4 mm/s
        referee.observe(tick * TICK)
    assert not referee.verdict().success


def test_what_happened_once_is_remembered():
    truth = good_truth()
    referee = Referee(episode(), truth, HAND)
    before = truth.poses["mug"]
    put("mug", dx=0.2, degrees=40)(truth)
    truth.touches.append(Touch("base_link", "mug", 200.0))
    referee.observe(TICK)
    truth.poses["mug"] = before
    truth.touches.pop()
    for tick in range(2, 40):
        referee.observe(tick * TICK)
    unmet = " ".join(referee.verdict().unmet)
    assert "mug was tilted" in unmet
    assert "mug was moved" in unmet
    assert "200 N" in unmet


def test_a_sleeping_item_still_touches_what_it_touched():
    truth = good_truth()
    referee = watch(truth)
    truth.touches = []
    referee.observe(2.0)
    assert referee.verdict().success


def test_an_item_that_never_touched_anything_is_not_on_the_table():
    truth = good_truth()
    truth.touches = []
    assert "can does not touch table_b" in watch(truth).verdict().unmet


def test_tilt_is_the_angle_of_the_axis_whatever_the_yaw():
    for yaw in (0.0, 1.0, -2.5):
        turned = Transform((0, 0, 0), quaternion_from_axis_angle((0, 0, 1), yaw))
        leaning = Transform((0, 0, 0), quaternion_from_axis_angle((0, 1, 0), 0.3))
        assert tilt(turned @ leaning) == pytest.approx(0.3)
        assert tilt(turned) == pytest.approx(0.0, abs=1e-7)


def test_without_a_goal_nothing_is_denied_but_danger_is_reported():
    truth = good_truth()
    truth.touches = [Touch("base_link", "table_b", 400.0)]
    referee = Referee(replace(episode(), goals=()), truth, HAND)
    referee.observe(TICK)
    verdict = referee.verdict()
    assert (verdict.success, verdict.unmet, verdict.demands) == (None, (), ())
    assert [incident.kind for incident in verdict.incidents] == ["force"]


MUG = replace(GOAL, item="mug", marker=None, max_others_shift=0.05)


def judged(truth: FakeTruth, *goals: Goal) -> Verdict:
    referee = Referee(replace(episode(), goals=goals, goals_place="w.yaml:7"), truth, HAND)
    for tick in range(1, 31):
        referee.observe(tick * TICK)
    return referee.verdict()


def test_each_of_several_demands_is_judged_and_told():
    truth = good_truth()
    met = judged(truth, GOAL, MUG)
    assert met.success
    assert met.demands == (
        Demanded("can on table_b beside tag", "w.yaml:7", True),
        Demanded("mug on table_b", "w.yaml:7", True),
    )
    assert {"can.tilt", "mug.tilt", "force"} <= set(met.measures)
    truth.poses["mug"] = tilted(truth.poses["mug"], 20)
    half = judged(truth, GOAL, MUG)
    assert half.success is False
    assert [demand.met for demand in half.demands] == [True, False]
    assert half.unmet == half.demands[1].unmet == ("mug is tilted 20.0 deg, more than 5.0 deg",)


def test_what_is_demanded_may_be_moved_and_the_strictest_limits_count():
    truth = good_truth()
    truth.poses["mug"] = Transform((-0.2, 0.3, TABLE_TOP))
    assert not judged(truth, GOAL).success
    assert judged(truth, GOAL, MUG).success
    truth = good_truth()
    truth.touches.append(Touch("base_link", "table_b", 120.0))
    assert judged(truth, GOAL, MUG).success
    assert not judged(truth, GOAL, replace(MUG, max_force=100.0)).success


LYING = Transform(
    (0.1, -0.1, TABLE_TOP + 0.035), quaternion_from_axis_angle((0, 1, 0), math.pi / 2)
)
"""The can on its side, its bottom at x = 0.1."""
LYING_GOAL = replace(GOAL, lying=True)


@pytest.mark.parametrize(
    ("pose", "sentence"),
    [
        (LYING, None),
        (LYING @ Transform((0, 0, 0), quaternion_from_axis_angle((0, 0, 1), 2.0)), None),
        (Transform((0.1, -0.1, TABLE_TOP)), "can is tilted 90.0 deg from level, more than 5.0 deg"),
        (Transform((0, 0, 0.02)) @ LYING, "can is 0.020 m above the top of table_b"),
        (
            Transform((0.2, 0, 0)) @ LYING,
            "the base of can is not whole on the top of table_b",
        ),
        (Transform((0.0, 0.57, 0)) @ LYING, "can is 0.38 m from tag, more than 0.35 m"),
    ],
)
def test_what_is_to_lie_is_judged_by_all_of_it(pose: Transform, sentence: str | None) -> None:
    truth = good_truth()
    truth.poses["can"] = pose
    verdict = judged(truth, replace(LYING_GOAL, max_distance=0.35))
    if sentence is None:
        assert verdict.success
    else:
        assert sentence in verdict.unmet


def test_what_lay_at_the_start_has_not_been_tilted() -> None:
    lying = Transform((-0.2, -0.3, TABLE_TOP + 0.035), LYING.quaternion)
    bodies = [replace(b, map_from_body=lying) if b.name == "mug" else b for b in episode().bodies]
    truth = good_truth()
    truth.poses["mug"] = lying
    referee = Referee(replace(episode(), bodies=tuple(bodies)), truth, HAND)
    referee.observe(TICK)
    assert referee.verdict().measures["others_tilt"] == pytest.approx(0.0, abs=1e-6)
    truth.poses["mug"] = Transform(lying.position)
    referee.observe(2 * TICK)
    assert referee.verdict().measures["others_tilt"] == pytest.approx(math.pi / 2)


@pytest.mark.parametrize("foot", [(0.0, 0.0, -0.065), (0.03, -0.02, -0.01), (-1.0, 0.5, 0.2)])
@pytest.mark.parametrize("lying", [False, True])
def test_where_the_origin_of_an_item_is_changes_nothing(
    foot: tuple[float, float, float], lying: bool
) -> None:
    plain, truth = episode(), good_truth()
    plain = replace(plain, goals=(replace(GOAL, lying=lying),))
    elsewhere = Transform(foot)
    bodies = tuple(with_foot(b, elsewhere) if b.name == "can" else b for b in plain.bodies)
    at = tilted(truth.poses["can"], 90.0 if lying else 3.0)
    x, y, z = at.position
    truth.poses["can"] = Transform((x, y, z + 0.035 if lying else z), at.quaternion)
    verdicts = []
    for given in (plain, replace(plain, bodies=bodies)):
        placed = given.body("can").with_foot_at(truth.poses["can"])
        referee = Referee(given, replace(truth, poses=truth.poses | {"can": placed}), HAND)
        for tick in range(30):
            referee.observe(tick * TICK)
        verdicts.append(referee.verdict())
    assert verdicts[0].success
    assert verdicts[1].success
    for name, value in verdicts[0].measures.items():
        assert verdicts[1].measures[name] == pytest.approx(value, abs=1e-9), name
