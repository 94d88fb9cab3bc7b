"""Checks of the hand: its grasp frame, its fingers, its table of openings."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.formats.urdf import read_urdf
from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import RobotDescription
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.find.base import Stand
from momantu_skills.robot_setup.find.reach import LADDER, reached
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.rays import opening_between

ALONG = 0.7
"""Least cosine between the grasp frame's axes and their required directions; less means a wrong
frame."""
SIDEWAYS = 0.5
"""Share of a finger's motion that must be along y: fingers that rotate also move outwards."""
MISFIT = (0.012, 0.15)
"""Largest difference between an opening and the distance of the hulls, m, and as a share of the
width."""
UNFIT = "opening-does-not-fit"
"""Code of the finding about such a difference."""
SAMPLES = (0.3, 0.6, 1.0)
"""Shares of the widest opening at which the table is compared with the fingers."""
LEVEL = math.radians(25)
"""How far off the horizontal the fingers may close in the pose `carry`, rad."""
HEIGHT_SHARE = 0.2
"""Share of the tables' heights at which objects at the largest distance must be in reach."""


def check_hand(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    """The end effector against the URDF's fingers."""
    effector = description.hand
    fingers = _fingers(description, body)
    if not fingers:
        yield FindingAtKeys(
            Severity.ERROR,
            "no-fingers",
            f"no link of `touch_links` moves with the joints of {effector.actuator}",
            "name the links of the fingers and the palm in `touch_links`",
            ("end_effector", "touch_links"),
        )
        return
    yield from _beyond(description, body)
    opened, closed = (
        _in_grasp(description, body, fingers, width) for width in (effector.max_width, 0.0)
    )
    palm = [n for n in effector.touch_links if n in body.hulls and n not in fingers]
    moves = np.array([c.mean(axis=0) - o.mean(axis=0) for c, o in zip(closed, opened, strict=True)])
    yield from _closing(moves)
    # the hull around a palm with a fixed jaw fills the hand: nothing is measured against it
    if moves[:, 1].min() < 0 < moves[:, 1].max():
        yield from _outwards(description, body, palm, closed)
        yield from _filled(description, body, palm)
        yield from _widths(description, body, fingers)
    yield from _carried(description)


def _carried(description: RobotDescription) -> Iterator[FindingAtKeys]:
    """A pose `carry` in which the fingers do not close level."""
    pose = description.named_poses["carry"]
    closing = description.kinematics().base_from_frame(description.hand.frame, pose).rotation[:, 1]
    lean = math.asin(min(abs(float(closing[2])), 1.0))
    if lean > LEVEL:
        yield FindingAtKeys(
            Severity.WARNING,
            "carry-not-level",
            f"in the pose carry the fingers close {math.degrees(lean):.0f} deg off the horizontal: "
            "what was gripped from the side leans as much",
            "give joints that hold the hand level",
            ("named_poses", "carry"),
        )


def _fingers(description: RobotDescription, body: Body) -> tuple[str, ...]:
    joints = set(description.hand.opening)
    return tuple(
        link
        for link in description.hand.touch_links
        if link in body.hulls and joints & {j.name for j in body.skeleton.chain(link)}
    )


def _beyond(description: RobotDescription, body: Body) -> Iterator[FindingAtKeys]:
    for joint, rows in description.hand.opening.items():
        lower, upper = body.skeleton.joints[joint].range
        outside = [p for w, p in rows if w > 0 and not lower - 1e-3 <= p <= upper + 1e-3]
        if outside and body.skeleton.joints[joint].mimic is None:
            yield FindingAtKeys(
                Severity.WARNING,
                "opening-beyond-limits",
                f"the opening of {joint} asks for {outside[0]:g}, and its range is {lower:g} to "
                f"{upper:g}",
                "give the positions that the joint can take",
                ("end_effector", "opening", joint),
            )


def _posture(description: RobotDescription, width: float) -> dict[str, float]:
    return {**description.named_poses["home"], **description.hand.positions(width)}


def _grasp(description: RobotDescription, posture: dict[str, float]) -> Transform:
    """base_from_grasp."""
    effector = description.hand
    link = description.kinematics().base_from_frame(effector.frame, posture)
    return link @ Transform((effector.grasp_offset, 0.0, 0.0))


def _in_grasp(
    description: RobotDescription, body: Body, links: tuple[str, ...], width: float
) -> list[Array]:
    """Corners (n, 3) of links in the grasp frame at an opening."""
    posture = _posture(description, width)
    grasp_from_base = _grasp(description, posture).inverse()
    poses = body.link_poses(posture, links)
    return [grasp_from_base.apply(placed(body.hulls[link], poses[link])) for link in links]


def _outwards(
    description: RobotDescription, body: Body, palm: list[str], fingers: list[Array]
) -> Iterator[FindingAtKeys]:
    if not palm:
        return
    own = np.vstack(_in_grasp(description, body, tuple(palm), 0.0))
    way = np.vstack(fingers).mean(axis=0) - own.mean(axis=0)
    along = way[0] / max(float(np.linalg.norm(way)), 1e-9)
    if along < ALONG:
        yield FindingAtKeys(
            Severity.ERROR,
            "grasp-frame-x",
            "x of the grasp frame does not point out along the fingers: from the palm to them it "
            f"is ({way[0]:.3f}, {way[1]:.3f}, {way[2]:.3f}) m in that frame",
            "put a frame between the pads under `frames`: x out along the fingers, y the closing "
            "direction",
            ("end_effector", "frame"),
        )


def _filled(description: RobotDescription, body: Body, palm: list[str]) -> Iterator[FindingAtKeys]:
    """Shapes of the palm that no one sees, between the open fingers."""
    links = read_urdf(description.urdf).links
    unseen = tuple(link.name for link in links if link.name in palm and not link.visuals)
    shapes = _in_grasp(description, body, unseen, description.hand.max_width)
    filling = [
        name
        for name, corners in zip(unseen, shapes, strict=True)
        if corners[:, 0].max() > 0.0 and corners[:, 1].min() < 0.0 < corners[:, 1].max()
    ]
    if filling:
        yield FindingAtKeys(
            Severity.ERROR,
            "hand-is-filled",
            f"collision shapes without a visual one reach between the open fingers, so that "
            f"nothing can be grasped: {', '.join(filling)}",
            "describe the robot without such shapes, which only keep a distance; a maker's xacro "
            "file has an argument for it, often that for a simulator",
            ("end_effector", "touch_links"),
        )


def _closing(moves: Array) -> Iterator[FindingAtKeys]:
    """moves: (n, 3), of each finger from open to closed in the grasp frame."""
    lengths = np.linalg.norm(moves, axis=1)
    largest = moves[int(np.argmax(lengths))]
    if lengths.max() < 1e-4:
        yield FindingAtKeys(
            Severity.ERROR,
            "fingers-do-not-move",
            "between open and closed the fingers stand still",
            "look at the positions in `opening`",
            ("end_effector", "opening"),
        )
    elif abs(largest[1]) < SIDEWAYS * lengths.max():
        yield FindingAtKeys(
            Severity.ERROR,
            "grasp-frame-y",
            "y of the grasp frame is not the closing direction: a finger moves by "
            f"({largest[0]:.3f}, {largest[1]:.3f}, {largest[2]:.3f}) m in that frame",
            "turn the frame about its x",
            ("end_effector", "frame"),
        )


def _widths(
    description: RobotDescription, body: Body, fingers: tuple[str, ...]
) -> Iterator[FindingAtKeys]:
    effector = description.hand
    for share in SAMPLES:
        width = share * effector.max_width
        corners = _in_grasp(description, body, fingers, width)
        gap = opening_between(corners, effector.pad_length, effector.pad_height)
        if gap is None:
            yield FindingAtKeys(
                Severity.WARNING,
                "no-pads-at-grasp",
                f"{width:.3f} m open, there is no finger to both sides of the grasp frame",
                "put the frame's origin between the pads",
                ("end_effector", "frame"),
            )
            return
        if abs(gap - width) > max(MISFIT[0], MISFIT[1] * width):
            yield FindingAtKeys(
                Severity.WARNING,
                UNFIT,
                f"where `opening` says {width:.3f} m, the fingers' hulls are {gap:.3f} m apart",
                "measure the table again: `momantu-bt robots setup` does",
                ("end_effector", "opening") if effector.opening else ("end_effector",),
            )
            return


def check_stand_off(description: RobotDescription) -> Iterator[FindingAtKeys]:
    """A distance from tables at which the base is in the table."""
    working = description.working
    c, s = math.cos(working.heading), math.sin(working.heading)
    front = max(c * x + s * y for x, y in description.footprint)
    if working.stand_off < front:
        yield FindingAtKeys(
            Severity.ERROR,
            "stands-in-table",
            f"at a stand-off of {working.stand_off:g} m the footprint, {front:.3g} m long that "
            "way, reaches over the table's edge",
            f"write at least `stand_off: {front + 0.05:.2f}`",
            ("working", "stand_off"),
        )


def check_reach(description: RobotDescription, stand: Stand) -> Iterator[FindingAtKeys]:
    """Working distances that the arm does not reach."""
    working, effector = description.working, description.hand
    solver = LimbSolver(
        description.kinematics(),
        description.groups["arm"].joints,
        description.joint_limits,
        effector.frame,
        Transform((effector.grasp_offset, 0.0, 0.0)),
        seed=0,
    )
    line = (working.heading, working.lateral)
    _, heights = reached(solver, np.array(working.reached), stand.floor, *line)
    for which, distance, share in zip(
        ("nearest", "best", "farthest"), working.reached, heights, strict=True
    ):
        if share < (0.5 if which == "best" else HEIGHT_SHARE):
            at = np.array([distance])
            others = [z for z in LADDER if reached(solver, at, stand.floor, *line, (z,))[1][0] > 0]
            told = ", ".join(f"{z:g}" for z in others) or "none from 0.1 to 1.2"
            yield FindingAtKeys(
                Severity.ERROR if which == "best" else Severity.WARNING,
                "out-of-reach",
                f"the {which} distance, {distance:g} m, is reached on {share:.0%} of the tables "
                f"0.4 to 0.8 m high; heights at which it is reached: {told} m",
                "let what it brings stand on tables of such heights, mount the arm elsewhere, or "
                "measure again how far the arm reaches: `momantu-bt robots setup`",
                ("working", "reach"),
            )
