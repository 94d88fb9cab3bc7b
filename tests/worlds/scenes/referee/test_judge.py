"""The judge: each sentence is true of a scene that is written down, and false of one beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.catalogue.furniture import furniture
from momantu_worlds.scenes.catalogue.objects import Thing
from momantu_worlds.scenes.catalogue.tags import tag_picture
from momantu_worlds.scenes.geometry.bodies import Body, Box, Part, Picture
from momantu_worlds.scenes.geometry.solids import PlacedBody, Scene
from momantu_worlds.scenes.referee.judge import ClaimJudge

from momantu_bt.claim import (
    BaseAt,
    BaseNear,
    CameraOn,
    GripperOpen,
    Holding,
    JointsAt,
    ObjectAt,
    ObjectOn,
    PlaneAt,
    RoomAt,
    SetDown,
    TagAt,
    TagOn,
)
from momantu_bt.geometry import Pose2D, Transform, quaternion_from_axis_angle, quaternion_from_rpy
from momantu_bt.messages import ObjectClass

FETCH = fetch()
CAMERA = FETCH.camera()[1].frame
TOP = 0.72
CAN = ObjectClass("can", diameter=0.07, height=0.13)
WHITE = (1.0, 1.0, 1.0)


def thing(name: str, kind: Any, size: tuple[float, float, float], x: float, y: float) -> Body:
    made = Thing(kind, size, 0.3, WHITE)
    return Body(name, kind, Transform((x, y, TOP)), made.parts(), static=False, mass=0.3)


def bodies() -> dict[str, Body]:
    table = Body("desk", "table", Transform((3.0, 1.0, 0.0)), furniture("table", (0.8, 1.4, TOP)))
    shelf = Body("shelf", "shelf", Transform((6.0, 0.0, 0.0)), furniture("shelf"))
    tag = Part(Picture((0.1875, 0.1875), tag_picture(1)), collision=False)
    all_of = (
        table,
        shelf,
        thing("can", "can", (0.07, 0.07, 0.13), 2.8, 0.7),
        thing("small_can", "can", (0.05, 0.05, 0.13), 2.8, 1.3),
        thing("carton", "box", (0.08, 0.14, 0.2), 3.1, 0.6),
        thing("mug", "mug", (0.08, 0.08, 0.09), 3.2, 1.1),
        Body("tag", "tag", Transform((2.9, 1.0, TOP + 0.0005)), (tag,)),
    )
    return {body.name: body for body in all_of}


HERE = Pose2D(2.0, 0.7, 0.3)


@dataclass
class Truth:
    """Ground truth that a test writes down. The hand is far off with its pads apart."""

    bodies: dict[str, Body] = field(default_factory=bodies)
    moved: dict[str, Transform] = field(default_factory=dict)
    links: dict[str, Transform] = field(default_factory=lambda: {"gripper_link": Transform()})
    joints: dict[str, float] = field(default_factory=dict)
    where: Pose2D = HERE

    def pose(self, body: str) -> Transform:
        return self.moved.get(body, self.bodies[body].map_from_body)

    def link(self, name: str) -> Transform:
        return self.links[name]

    def base(self) -> Pose2D:
        return self.where

    def joint(self, name: str) -> float:
        return self.joints.get(name, 0.05)

    def hold(self, body: str, *, lifted: float, beside: float = 0.0, width: float = 0.07) -> None:
        """Put the hand around the middle of a body, and raise both."""
        x, y, z = self.pose(body).position
        self.moved[body] = Transform((x, y, z + lifted))
        self.links["gripper_link"] = Transform((x + beside, y, z + lifted + 0.06))
        self.joints |= dict.fromkeys(FETCH.actuators["gripper"].joints, width / 2)


ODOM = Pose2D(0.4, -0.2, 1.0)
"""Where odometry believes the base to be."""


def judged(sentence: Any, truth: Truth) -> bool | None:
    return ClaimJudge(FETCH, truth.bodies, truth).judge(sentence, ODOM.transform())


def in_odom(truth: Truth, x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> Transform:
    """A pose in the map as the robot would have it."""
    odom_from_map = ODOM.transform() @ truth.base().transform().inverse()
    return odom_from_map @ Transform((x, y, z), quaternion_from_rpy(0.0, 0.0, yaw))


def point(truth: Truth, x: float, y: float, z: float) -> tuple[float, float, float]:
    a, b, c = (float(v) for v in in_odom(truth, x, y, z).position)
    return a, b, c


MIDDLE = TOP + 0.065


@pytest.mark.parametrize(
    ("asked", "x", "said"),
    [
        (CAN, 2.80, True),
        (CAN, 2.81, True),
        (CAN, 2.84, False),
        (ObjectClass("bottle"), 2.80, False),
        (replace(CAN, diameter=0.05), 2.80, False),
        (replace(CAN, height=0.16), 2.80, False),
        (ObjectClass("can"), 2.80, True),
    ],
)
def test_an_object_is_where_and_what_it_is_said_to_be(
    asked: ObjectClass, x: float, said: bool
) -> None:
    truth = Truth()
    assert judged(ObjectAt(asked, in_odom(truth, x, 0.7, MIDDLE), 0.02), truth) is said


def test_a_mug_is_where_its_axis_is_however_far_its_handle_stands_out() -> None:
    truth = Truth()
    mug = ObjectClass("mug", diameter=0.08, height=0.09)
    x, y, z = PlacedBody(truth.bodies["mug"], truth.pose("mug")).centre
    assert (x, y, z) == pytest.approx((3.2, 1.1, TOP + 0.045), abs=1e-3)
    for yaw in (0.0, 1.0, 2.5):
        truth.moved["mug"] = Transform((3.2, 1.1, TOP), quaternion_from_rpy(0.0, 0.0, yaw))
        assert judged(ObjectAt(mug, in_odom(truth, 3.2, 1.1, TOP + 0.045), 0.005), truth) is True


def test_a_toppled_or_lifted_object_does_not_stand() -> None:
    truth = Truth()
    claim = ObjectAt(CAN, in_odom(truth, 2.8, 0.7, MIDDLE), 0.1)
    assert judged(claim, truth) is True
    lying = quaternion_from_axis_angle((1.0, 0.0, 0.0), math.pi / 2)
    truth.moved["can"] = Transform((2.8, 0.7, TOP + 0.035), lying)
    assert judged(claim, truth) is False
    truth.moved["can"] = Transform((2.8, 0.7, TOP + 0.02))
    assert judged(claim, truth) is False


@pytest.mark.parametrize(
    ("asked", "surface", "said"),
    [
        (CAN, "desk", True),
        (CAN, None, True),
        (CAN, "shelf", False),
        (CAN, "bench", None),
        (ObjectClass("bowl"), "desk", False),
        (ObjectClass("box", width=0.14, depth=0.08), "desk", True),
        (ObjectClass("box", width=0.11, depth=0.08), "desk", False),
        (ObjectClass("mug", diameter=0.08), "desk", True),
    ],
)
def test_objects_stand_on_surfaces(asked: ObjectClass, surface: str, said: bool | None) -> None:
    assert judged(ObjectOn(asked, surface), Truth()) is said


def test_an_object_on_the_floor_stands_on_no_surface_but_stands() -> None:
    truth = Truth(moved={"can": Transform((0.5, 0.5, 0.0))})
    assert judged(ObjectOn(CAN, "desk"), truth) is False
    assert judged(ObjectOn(CAN), truth) is True


@pytest.mark.parametrize(
    ("tag_id", "x", "yaw", "said"),
    [(1, 2.9, 0.0, True), (1, 2.95, 0.0, False), (1, 2.9, 0.2, False), (2, 2.9, 0.0, False)],
)
def test_a_tag_is_where_it_is_said_to_be(tag_id: int, x: float, yaw: float, said: bool) -> None:
    truth = Truth()
    claim = TagAt(tag_id, in_odom(truth, x, 1.0, TOP, yaw), 0.03, 0.1)
    assert judged(claim, truth) is said


def test_a_tag_lies_on_a_surface_until_something_covers_it() -> None:
    truth = Truth()
    assert judged(TagOn(1, "desk"), truth) is True
    assert judged(TagOn(1), truth) is True
    assert judged(TagOn(1, "shelf"), truth) is False
    assert judged(TagOn(2, "desk"), truth) is False
    assert judged(TagOn(500), truth) is False
    truth.moved["mug"] = Transform((2.97, 1.0, TOP))
    assert judged(TagOn(1, "desk"), truth) is False


@pytest.mark.parametrize(
    "cover",
    [
        Part(Box((0.25, 0.25, 0.002)), Transform((0.0, 0.0, 0.003))),
        Part(Picture((0.1875, 0.1875), tag_picture(2)), Transform((0, 0, 0.001)), collision=False),
    ],
    ids=["sheet", "tag"],
)
def test_a_tag_under_paper_is_covered_and_another_one_may_lie_open(cover: Part) -> None:
    truth = Truth()
    truth.bodies["cover"] = Body("cover", "cover", Transform((2.9, 1.0, TOP)), (cover,))
    assert judged(TagOn(1, "desk"), truth) is False
    assert judged(TagOn(2, "desk"), truth) is isinstance(cover.geometry, Picture)
    truth.moved["cover"] = Transform((2.9, 1.4, TOP))
    assert judged(TagOn(1, "desk"), truth) is True


@pytest.mark.parametrize(
    ("x", "z", "said"),
    [(3.0, TOP, True), (3.0, TOP + 0.015, True), (3.0, TOP + 0.03, False), (2.5, TOP, False)],
)
def test_a_plane_is_a_top_at_that_height(x: float, z: float, said: bool) -> None:
    truth = Truth()
    assert judged(PlaneAt(in_odom(truth, x, 1.0, z), 0.02), truth) is said


@pytest.mark.parametrize(
    ("x", "y", "within", "said"),
    [
        (2.9, 1.0, 0.0, True),
        (2.9, 0.7, 0.0, True),
        (2.87, 0.7, 0.0, False),
        (2.87, 0.7, 0.1, True),
        (2.64, 1.0, 0.0, False),
        (2.64, 1.0, 0.05, True),
        (2.4, 1.0, 0.1, False),
    ],
)
def test_room_is_beside_things_and_within_the_edge(
    x: float, y: float, within: float, said: bool
) -> None:
    truth = Truth()
    claim = RoomAt(point(truth, x, y, TOP), 0.05, 0.02, within)
    assert judged(claim, truth) is said


def test_what_is_in_the_hand_takes_no_room() -> None:
    truth = Truth()
    claim = RoomAt(point(truth, 2.8, 0.7, TOP), 0.035, 0.02)
    assert judged(claim, truth) is False
    truth.hold("can", lifted=0.05)
    assert judged(claim, truth) is True


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-1.0, 1.0), st.floats(0.01, 0.2))
def test_the_base_is_at_a_pose_within_its_tolerances(
    x: float, y: float, turn: float, tolerance: float
) -> None:
    truth = Truth()
    goal = truth.where @ Pose2D(x, y, turn)
    far = math.hypot(x, y)
    if min(abs(far - tolerance), abs(abs(turn) - 0.5)) > 1e-6:
        said = far < tolerance and abs(turn) < 0.5
        assert judged(BaseAt(goal, tolerance, 0.5), truth) is said
        near = tuple(float(v) for v in in_odom(truth, goal.x, goal.y).position[:2])
        assert judged(BaseNear(near, tolerance), truth) is (far < tolerance)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("lifted", "beside", "width", "said"),
    [
        (0.05, 0.0, 0.07, True),
        (0.05, 0.05, 0.07, True),
        (0.05, 0.08, 0.07, False),
        (0.0, 0.0, 0.07, False),
        (0.001, 0.0, 0.07, False),
        (0.05, -0.2, 0.0, False),
    ],
)
def test_held_is_what_is_between_the_pads_and_off_the_table(
    lifted: float, beside: float, width: float, said: bool
) -> None:
    truth = Truth()
    truth.hold("can", lifted=lifted, beside=beside, width=width)
    assert judged(Holding(True), truth) is said
    assert judged(Holding(False), truth) is not said


@pytest.mark.parametrize(("kind", "beside"), [("carton", 0.0), ("mug", 0.04)])
def test_boxes_and_the_walls_of_mugs_can_be_held(kind: str, beside: float) -> None:
    truth = Truth()
    truth.hold(kind, lifted=0.1, beside=beside, width=0.08)
    assert judged(Holding(True), truth) is True


def test_a_thing_is_set_down_when_it_stands_and_the_hand_is_away() -> None:
    truth = Truth()
    claim = SetDown(in_odom(truth, 2.82, 0.7, MIDDLE), 0.04)
    assert judged(claim, truth) is True
    assert judged(SetDown(in_odom(truth, 2.86, 0.7, MIDDLE), 0.04), truth) is False
    truth.hold("can", lifted=0.0)
    assert judged(claim, truth) is False
    truth.links["gripper_link"] = Transform()
    assert judged(claim, truth) is True
    tilted = quaternion_from_axis_angle((1.0, 0.0, 0.0), 0.3)
    truth.moved["can"] = Transform((2.8, 0.7, TOP + 0.01), tilted)
    assert judged(claim, truth) is False


def test_the_gripper_is_as_open_as_its_fingers_are_apart() -> None:
    truth = Truth()
    assert judged(GripperOpen(0.099), truth) is True
    assert judged(GripperOpen(0.101), truth) is False


def test_joints_that_turn_for_ever_are_compared_modulo_turns() -> None:
    truth = Truth(joints={"wrist_roll_joint": 0.1 + 4 * math.pi, "elbow_flex_joint": 0.1})
    both = ("wrist_roll_joint", "elbow_flex_joint")
    assert judged(JointsAt(both, (0.11, 0.09), 0.03), truth) is True
    assert judged(JointsAt(both, (0.11, 0.05), 0.03), truth) is False
    assert judged(JointsAt(both, (0.15, 0.09), 0.03), truth) is False
    assert judged(JointsAt(both[1:], (0.1 + 2 * math.pi,), 0.03), truth) is False


@pytest.mark.parametrize(("yaw", "said"), [(0.0, True), (0.09, True), (0.12, False), (3.0, False)])
def test_a_camera_looks_at_what_is_on_its_axis(yaw: float, said: bool) -> None:
    truth = Truth()
    ahead = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    turned = Transform((1.0, 0.0, 1.1), quaternion_from_rpy(0.0, 0.0, yaw))
    truth.links[CAMERA] = turned @ Transform.from_rotation(ahead)
    assert judged(CameraOn(CAMERA, point(truth, 3.0, 0.0, 1.1), 0.1), truth) is said


@given(st.floats(-math.pi, math.pi), st.floats(-1.2, 1.2), st.floats(0.0, 0.5))
def test_a_body_however_it_is_turned_keeps_its_size_and_holds_its_centre(
    yaw: float, lean: float, up: float
) -> None:
    for body in bodies().values():
        if body.static:
            continue
        turn = quaternion_from_rpy(lean, 0.0, yaw)
        standing = PlacedBody(body, Transform((1.0, 2.0, 1.0 + up), turn))
        upright = PlacedBody(body, Transform())
        assert standing.size == pytest.approx(upright.size)
        assert standing.lowest <= standing.centre[2] <= standing.highest
        reach = float(np.linalg.norm(standing.size)) / 2
        assert standing.highest - standing.lowest <= 2 * reach + 1e-9
        middles = np.array([solid.map_from_part.position for solid in standing.solids])
        if body.category in ("can", "box"):
            assert standing.inside(middles).all()
        for solid in standing.solids:
            away = solid.vertices[:, :2].mean(axis=0)
            assert solid.beside(away) <= 0.0
            assert solid.beside(away + np.array([3.0, 4.0])) == pytest.approx(5.0, abs=0.6)


def test_below_a_body_is_the_highest_top_under_its_middle() -> None:
    truth = Truth()
    scene = Scene(truth.bodies, truth.pose)
    assert scene.below(scene.body("can")) == ("desk", pytest.approx(0.0))
    truth.moved["can"] = Transform((2.8, 0.7, TOP + 0.2))
    assert scene.below(scene.body("can")) == ("desk", pytest.approx(0.2))
    truth.moved["can"] = Transform((2.8, 0.7, 0.1))
    assert scene.below(scene.body("can")) == ("floor", pytest.approx(0.1))


LAID = Transform((2.8, 0.7, TOP + 0.035), quaternion_from_rpy(0.0, math.pi / 2, 0.4))
"""The can on its side; its middle is half of its height along the axis."""


@pytest.mark.parametrize(
    ("yaw", "said"), [(0.4, True), (0.4 + math.pi, True), (0.6, True), (1.0, False), (2.0, False)]
)
def test_what_lies_is_along_the_axis_that_is_told(yaw: float, said: bool) -> None:
    truth = Truth()
    truth.moved["can"] = LAID
    x, y, z = LAID.apply((0.0, 0.0, 0.065))
    level = in_odom(truth, x, y, z, yaw) @ Transform(
        (0.0, 0.0, 0.0), quaternion_from_rpy(0.0, math.pi / 2, 0.0)
    )
    assert judged(ObjectAt(CAN, level, 0.02), truth) is said
    assert judged(SetDown(level, 0.02), truth) is said


def test_what_stands_does_not_lie_and_the_other_way_round() -> None:
    truth = Truth()
    level = in_odom(truth, 2.8, 0.7, MIDDLE) @ Transform(
        (0.0, 0.0, 0.0), quaternion_from_rpy(0.0, math.pi / 2, 0.0)
    )
    assert judged(SetDown(level, 0.02), truth) is False
    truth.moved["can"] = LAID
    x, y, z = LAID.apply((0.0, 0.0, 0.065))
    assert judged(SetDown(in_odom(truth, x, y, z), 0.02), truth) is False
