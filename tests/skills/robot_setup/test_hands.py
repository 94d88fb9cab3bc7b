"""Laws of hands: the opening that is written is the gap that the fingers leave, for any fingers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.find.arms import find_limbs
from momantu_skills.robot_setup.find.fingers import NEAR, STEPS, Hand, find_hands
from momantu_skills.robot_setup.find.grasp import APART, LINEAR, STRONGEST, Grasp, find_grasp
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.rays import opening_between

from momantu_bt.geometry import Transform
from tests.skills.robot_setup.conftest import body_of, box, joint, link

BASE = link("base_link", box(0.4, 0.4, 0.2), "0 0 0.1")
TURNS = st.tuples(st.floats(-3, 3), st.floats(-1, 1), st.floats(-3, 3))


def palm(height: float, turn: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> list[str]:
    rpy = "{:.6f} {:.6f} {:.6f}".format(*turn)
    shape = link("palm", box(0.1, 0.08, height), f"0 0 {height / 2}")
    return [BASE, shape, joint("turn", "base_link", "palm", "0 0 0.6", rpy=rpy)]


def slides(length: float, effort: float = 20.0) -> list[str]:
    limit = f'lower="0" upper="{length}" velocity="0.05" effort="{effort}"'
    return [
        joint("ls", "palm", "lf", axis="1 0 0", kind="prismatic", limit=limit),
        joint("rs", "palm", "rf", axis="-1 0 0", kind="prismatic", limit=limit),
    ]


def hinges(to: float, out: float, extra: str = "", effort: float = 5.0) -> list[str]:
    limit = f'lower="0" upper="{to}" velocity="1" effort="{effort}"'
    return [
        joint("lh", "palm", "lf", f"0 {out} 0.07", "-1 0 0", limit=limit),
        joint("rh", "palm", "rf", f"0 {-out} 0.07", "1 0 0", limit=limit, extra=extra),
    ]


def only_hand(body: Body) -> tuple[Hand, Grasp]:
    (hand,) = find_hands(body)
    return hand, find_grasp(body, hand)


def gap(body: Body, hand: Hand, grasp: Grasp, posture: dict[str, float]) -> float | None:
    """Between the fingers' hulls at the pads' middle, m."""
    poses = body.link_poses(posture)
    place = grasp.link_from_grasp or Transform((grasp.offset, 0.0, 0.0))
    grasp_from_base = (Transform.from_matrix(poses[grasp.link]) @ place).inverse()
    fingers = [name for name in (*hand.ahead, *hand.behind) if name in body.hulls]
    corners = [grasp_from_base.apply(placed(body.hulls[n], poses[n])) for n in fingers]
    return opening_between(corners, grasp.pad_length, grasp.pad_height)


def assert_the_opening_is_true(body: Body, hand: Hand, grasp: Grasp) -> None:
    """Rows rise, lie within the joints' ranges, and name the gap that there is."""
    tables = list(grasp.opening.values())
    assert tables
    for rows in tables:
        steps = np.diff(np.array(rows), axis=0)
        assert (steps[:, 0] > 0).all()
        assert (steps[:, 1] > 0).all() or (steps[:, 1] < 0).all()
        assert (rows[0][0], rows[-1][0]) == (0.0, grasp.max_width)
    for at in zip(*tables, strict=True):
        (width,) = {row[0] for row in at}
        if width < max(grasp.thinnest, APART):  # beyond where the fingers can close
            continue
        posture = dict(zip(grasp.opening, (row[1] for row in at), strict=True))
        for name, position in posture.items():
            low, high = body.skeleton.joints[name].range
            assert low - 1e-5 <= position <= high + 1e-5
        assert gap(body, hand, grasp, posture) == pytest.approx(width, abs=1.2 * LINEAR)


@given(
    TURNS, st.floats(0.01, 0.06), st.floats(0.005, 0.02), st.floats(0.01, 0.04),
    st.floats(0.02, 0.08), st.sampled_from([0.0, 0.003, 0.01]), st.floats(0.1, 80),
)  # fmt: skip
@settings(max_examples=25)
def test_a_parallel_gripper_is_measured_however_it_is_mounted(
    turn: tuple[float, float, float],
    travel: float,
    thick: float,
    high: float,
    long: float,
    apart: float,
    effort: float,
) -> None:
    at = f"{thick / 2 + apart / 2} 0 {0.06 + long / 2}"
    shape = box(thick, high, long)
    fingers = [link("lf", shape, at), link("rf", shape, f"-{at}")]
    body = body_of(*palm(0.06, turn), *fingers, *slides(travel, effort))
    hand, grasp = only_hand(body)
    assert_the_opening_is_true(body, hand, grasp)
    assert grasp.max_width == pytest.approx(2 * travel + apart, abs=1e-3)
    assert grasp.thinnest == pytest.approx(apart, abs=1e-4)
    assert grasp.pad_length == pytest.approx(max(long, 0.02), abs=1.1e-3)
    assert grasp.pad_height == pytest.approx(max(high, 0.02), abs=1.1e-3)
    assert grasp.hand_clearance == pytest.approx(long / 2, abs=2e-3)
    assert grasp.link == "palm"
    assert grasp.link_from_grasp is not None
    x, y = grasp.link_from_grasp.rotation[:, 0], grasp.link_from_grasp.rotation[:, 1]
    assert x == pytest.approx((0, 0, 1), abs=1e-6)
    assert abs(y) == pytest.approx((1, 0, 0), abs=1e-6)
    assert 0 < grasp.max_force == pytest.approx(min(STRONGEST, 2 * effort), abs=0.06)


@given(
    st.floats(0.3, 1.0), st.floats(0.05, 0.12), st.floats(0.015, 0.04), st.floats(0.0, 1.0),
    st.booleans(),
)  # fmt: skip
@settings(max_examples=25)
def test_hinged_fingers_are_as_far_apart_as_their_opening_says(
    to: float, long: float, out: float, inwards: float, follows: bool
) -> None:
    inner = inwards * (out - 0.005)
    assume(2 * (out - inner) - 0.01 < 0.9 * NEAR)
    shape = box(0.02, 0.01, long)
    fingers = [
        link("lf", shape, f"0 {-inner} {long / 2}"),
        link("rf", shape, f"0 {inner} {long / 2}"),
    ]
    extra = '<mimic joint="lh" multiplier="1"/>' if follows else ""
    body = body_of(*palm(0.06), *fingers, *hinges(to, out, extra))
    hand, grasp = only_hand(body)
    assert_the_opening_is_true(body, hand, grasp)
    assert set(grasp.opening) == {"lh", "rh"}
    assert (np.diff(hand.widths) <= 0).all()
    assert len(hand.widths) == STEPS


def test_fingers_that_pass_through_each_other_close_where_they_touch() -> None:
    shape = box(0.01, 0.02, 0.04)
    fingers = [link("lf", shape, "-0.015 0 0.08"), link("rf", shape, "0.015 0 0.08")]
    body = body_of(*palm(0.06), *fingers, *slides(0.05))
    hand, grasp = only_hand(body)
    assert_the_opening_is_true(body, hand, grasp)
    assert grasp.thinnest == pytest.approx(0.0, abs=1e-4)
    # each finger's inner face begins 2 cm beyond the middle: there it has to go first
    assert grasp.opening["ls"][0] == pytest.approx((0.0, 0.02), abs=1e-4)
    assert grasp.max_width == pytest.approx(0.06, abs=1e-3)


def test_one_finger_may_close_against_one_that_stands() -> None:
    """The other only turns about its own length."""
    shape = box(0.01, 0.02, 0.04)
    moving, _ = slides(0.05)
    parts = [
        link("lf", shape, "0.005 0 0.08"),
        link("rf", shape, "0 0 0.08"),
        joint("spin", "palm", "rf", "-0.005 0 0"),
    ]
    hand, grasp = only_hand(body_of(*palm(0.06), *parts, moving))
    assert (hand.ahead, hand.behind) == (("lf",), ("rf",))
    assert set(grasp.opening) == {"ls"}
    assert grasp.max_width == pytest.approx(0.05, abs=1e-3)


def test_three_fingers_around_a_palm_are_one_hand() -> None:
    parts = []
    for i, angle in enumerate(np.radians((0, 120, 240))):
        c, s = np.cos(angle), np.sin(angle)
        axis = f"{-s:.6f} {c:.6f} 0"
        parts += [
            link(f"f{i}", box(0.012, 0.012, 0.08), "0 0 0.04", 0.05),
            joint(
                f"j{i}", "palm", f"f{i}", f"{0.04 * c:.6f} {0.04 * s:.6f} 0.06", axis,
                limit='lower="-0.4" upper="0.6" velocity="1" effort="2"',
            ),
        ]  # fmt: skip
    hand, grasp = only_hand(body_of(*palm(0.06), *parts))
    assert set(hand.leaders) == {"j0", "j1", "j2"}
    assert {link for b in hand.branches for link in b.links} == {"f0", "f1", "f2"}
    assert grasp.max_width > 0.03


JAW = [
    link("palm", box(0.05, 0.05, 0.1), "0 0.03 0.05"),
    joint("turn", "base_link", "palm", "0 0 0.6"),
    link("jaw", box(0.02, 0.01, 0.1), "0 -0.005 0.05"),
]


def jaw_joint(name: str) -> str:
    limit = 'lower="0" upper="0.8" velocity="1" effort="3"'
    return joint(name, "palm", "jaw", "0 0 0", "1 0 0", limit=limit)


def test_a_single_jaw_is_a_hand_where_it_is_called_one() -> None:
    hand, grasp = only_hand(body_of(BASE, *JAW, jaw_joint("gripper_jaw")))
    assert hand.single
    assert (hand.ahead, hand.behind) == (("jaw",), ("palm",))
    assert grasp.opening["gripper_jaw"][-1][0] == grasp.max_width
    # its tip, 10 cm from the hinge, goes by a chord of 0.8 rad
    assert grasp.max_width == pytest.approx(0.2 * np.sin(0.4), abs=4e-3)
    rows = np.array(grasp.opening["gripper_jaw"])
    assert (np.diff(rows, axis=0)[:, 0] > 0).all()
    named = [part.replace("jaw", "flap") for part in (*JAW, jaw_joint("last_wrist"))]
    assert find_hands(body_of(BASE, *named)) == ()


@pytest.mark.parametrize(
    ("why", "parts"),
    [
        ("it never closes", [
            link("lf", box(0.01, 0.02, 0.04), "0.03 0 0.08"),
            link("rf", box(0.01, 0.02, 0.04), "-0.03 0 0.08"), *slides(0.05)]),
        ("it hardly opens", [
            link("lf", box(0.01, 0.02, 0.04), "0.005 0 0.08"),
            link("rf", box(0.01, 0.02, 0.04), "-0.005 0 0.08"), *slides(0.003)]),
        ("its fingers are as long as arms", [
            link("lf", box(0.02, 0.01, 0.3), "0 0 0.15"),
            link("rf", box(0.02, 0.01, 0.3), "0 0 0.15"), *hinges(0.5, 0.01)]),
        ("its fingers have no shape", [link("lf"), link("rf"), *slides(0.05)]),
        ("its fingers slide out, not together", [
            link("lf", box(0.01, 0.02, 0.04), "0.02 0 0.08"),
            link("rf", box(0.01, 0.02, 0.04), "-0.02 0 0.08"),
            *(s.replace("-1 0 0", "0 0 1").replace("1 0 0", "0 0 1") for s in slides(0.05))]),
    ],
)  # fmt: skip
def test_what_does_not_open_and_close_is_no_hand(why: str, parts: list[str]) -> None:
    assert find_hands(body_of(*palm(0.06), *parts)) == (), why


def test_two_wheels_on_a_base_are_no_hand() -> None:
    shape = '<cylinder radius="0.05" length="0.02"/>'
    wheels = []
    for name, y in (("l", 0.1), ("r", -0.1)):
        wheels += [
            link(name, shape, rpy="1.5708 0 0"),
            joint(f"{name}j", "base_link", name, f"0 {y} 0.05", "0 1 0", "continuous"),
        ]
    assert find_hands(body_of(BASE, *wheels)) == ()


@pytest.mark.parametrize("along", [0.0, -0.03])
def test_a_tool_frame_between_the_pads_is_the_grasp_frame(along: float) -> None:
    """A frame that lies nearer to the palm is moved by an offset along its x."""
    fingers = [
        link("lf", box(0.01, 0.02, 0.04), "0.005 0 0.08"),
        link("rf", box(0.01, 0.02, 0.04), "-0.005 0 0.08"),
    ]
    tool = [
        link("tool0"),
        joint("t", "palm", "tool0", f"0 0 {0.08 + along}", kind="fixed", rpy="0 -1.5708 1.5708"),
    ]
    _, grasp = only_hand(body_of(*palm(0.06), *fingers, *slides(0.04), *tool))
    assert (grasp.link, grasp.link_from_grasp) == ("tool0", None)
    assert grasp.offset == pytest.approx(-along, abs=1e-3)


def test_without_efforts_the_force_is_a_guess() -> None:
    fingers = [
        link("lf", box(0.01, 0.02, 0.04), "0.005 0 0.08"),
        link("rf", box(0.01, 0.02, 0.04), "-0.005 0 0.08"),
    ]
    _, grasp = only_hand(body_of(*palm(0.06), *fingers, *slides(0.04, effort=0)))
    assert not grasp.force_known
    assert 0 < grasp.max_force < STRONGEST
    forces = [
        only_hand(body_of(*palm(0.06), *fingers, *slides(0.04, e)))[1].max_force for e in (1, 9, 70)
    ]
    assert forces == [2.0, 18.0, STRONGEST]


def test_finger_hinges_without_a_range_are_a_hand() -> None:
    """As in files whose ranges come from a calibration: from 0 to 0, each with its own motor."""
    fingers = [
        link("lf", box(0.02, 0.01, 0.1), "0 0 0.05"),
        link("rf", box(0.02, 0.01, 0.1), "0 0 0.05"),
    ]
    body = body_of(*palm(0.06), *fingers, *hinges(0.0, 0.03))
    (hand,) = find_hands(body)
    assert set(hand.leaders) == {"lh", "rh"}
    assert 0.05 < hand.widths[0] < 0.3
    assert max(abs(q) for ends in hand.leaders.values() for q in ends) < 1.0


def test_joints_of_fingers_are_no_joints_of_an_arm() -> None:
    """Where no hand is found, the longest chain is the arm, without what is called a finger."""
    links = [BASE, *(link(f"l{i}", box(0.05, 0.05, 0.2), "0 0 0.1") for i in range(5))]
    arm = [
        joint(f"j{i}", "base_link" if i == 0 else f"l{i - 1}", f"l{i}", "0 0 0.2", "0 1 0")
        for i in range(5)
    ]
    finger = [link("finger_1", box(0.01, 0.01, 0.3), "0 0 0.15")]
    body = body_of(*links, *arm, *finger, joint("f", "l4", "finger_1", "0 0 0.2", "0 0 1"))
    limbs = find_limbs(body, (), None, ())
    assert limbs.arm is not None
    assert limbs.arm.joints == tuple(f"j{i}" for i in range(5))


def test_a_motor_beside_the_fingers_leads_them_and_their_springs_stay() -> None:
    """The motor's link has no shape; each finger is a driven piece, and on a spring the tip."""
    follow = '<mimic joint="motor"/>'
    free = 'lower="0" upper="0.7" velocity="1" effort="5"'
    parts = [link("dial", mass=0.1), joint("motor", "palm", "dial", limit=free)]
    for side, out in (("l", 0.03), ("r", -0.03)):
        axis = "-1 0 0" if out > 0 else "1 0 0"
        parts += [
            link(f"{side}f", box(0.02, 0.01, 0.05), "0 0 0.025"),
            link(f"{side}t", box(0.02, 0.01, 0.05), f"0 {-0.8 * out} 0.025"),
            joint(f"{side}h", "palm", f"{side}f", f"0 {out} 0.07", axis, limit=free, extra=follow),
            joint(f"{side}s", f"{side}f", f"{side}t", "0 0 0.05", axis, limit=free),
        ]
    body = body_of(*palm(0.06), *parts)
    (hand,) = find_hands(body)
    assert set(hand.leaders) == {"motor", "lh", "rh"}
    limbs = find_limbs(body, (hand,), None, ())
    assert {"ls", "rs"} <= set(limbs.rest)
    assert "motor" not in limbs.rest


@pytest.mark.parametrize("aside", ["0 0.08 0.03", "0 -0.1 0", "0.09 0 0.02"])
def test_a_camera_on_the_palm_does_not_turn_the_grasp_frame(aside: str) -> None:
    body = body_of(
        *palm(0.08),
        link("eye", box(0.03, 0.03, 0.03)),
        joint("bracket", "palm", "eye", aside, kind="fixed"),
        link("lf", box(0.01, 0.02, 0.06), "-0.045 0 0.12"),
        link("rf", box(0.01, 0.02, 0.06), "0.045 0 0.12"),
        *slides(0.035),
    )
    _, grasp = only_hand(body)
    assert grasp.link_from_grasp is not None
    assert grasp.link_from_grasp.rotation[:, 0] == pytest.approx((0.0, 0.0, 1.0), abs=1e-6)


@pytest.mark.parametrize("spreads", [False, True])
def test_of_joints_in_a_row_the_knuckles_close_the_hand(spreads: bool) -> None:
    """The tips stay straight, and joints that spread two fingers apart stay where they are."""
    bend = 'lower="0" upper="1.2" velocity="1" effort="5"'
    turn = 'lower="-0.2" upper="0.2" velocity="1" effort="5"'
    fingers: list[str] = []
    for name, x, y, axis in (("a", 0.05, 0.03, "0 -1 0"), ("b", 0.05, -0.03, "0 -1 0"),
                             ("c", -0.05, 0.0, "0 1 0")):  # fmt: skip
        root = "palm"
        if spreads and name != "c":
            root, away = f"{name}0", "0 0 1" if name == "a" else "0 0 -1"
            fingers += [link(root, box(0.02, 0.02, 0.01), "0 0 0.005", 0.05)]
            fingers += [joint(f"{name}_spread", "palm", root, f"{x} {y} 0.08", away, limit=turn)]
        at = f"{x} {y} 0.08" if root == "palm" else "0 0 0.01"
        fingers += [
            link(f"{name}1", box(0.012, 0.02, 0.05), "0 0 0.025", 0.05),
            link(f"{name}2", box(0.012, 0.02, 0.05), "0 0 0.025", 0.05),
            joint(f"{name}_knuckle", root, f"{name}1", at, axis, limit=bend),
            joint(f"{name}_tip", f"{name}1", f"{name}2", "0 0 0.05", axis, limit=bend),
        ]
    body = body_of(*palm(0.06), *fingers)
    hand, grasp = only_hand(body)
    assert set(hand.leaders) == {"a_knuckle", "b_knuckle", "c_knuckle"}
    assert {frozenset(hand.ahead), frozenset(hand.behind)} == {
        frozenset(["a2", "b2"]),
        frozenset(["c2"]),
    }
    assert abs(hand.closing[0]) > 0.95
    assert 0.07 < grasp.max_width < 0.1
    assert hand.leaders["a_knuckle"][0] == 0.0
