"""The four poses that every robot has, and what each of them is for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from momantu_bt.geometry import Transform
from momantu_skills.robot_setup.find.arms import Limbs
from momantu_skills.robot_setup.find.base import Stand
from momantu_skills.robot_setup.find.limits import short_range
from momantu_skills.robot_setup.find.poses import (
    AROUND,
    FLOOR_AHEAD,
    HELD,
    HIGH,
    LOW,
    TABLE,
    TARGETS,
    FoundPose,
    PoseFinder,
    looking,
    posed,
)
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver
from momantu_skills.robot_setup.urdf.body import Body

RAISED = (0.3, 0.5, 0.7)
"""Shares of a lift's range that are tried where the arm cannot be folded with it down."""
FAR_OUT = 0.1
"""How far out of the footprint a folded arm may reach before a raised lift is tried, m."""
OUT, BESIDE = 2.0, 5.0
"""Cost of an arm that leaves the footprint, per m, where 1 is an arm that fills the picture: while
the robot drives, and beside a table."""
TIPS = "no clear posture was found that holds the hand level: what is held tips"
CROWDED = 10.0
"""Cost of what is held reaching into the robot, per m."""
GLIMPSE = 0.02
"""Share of the arm's corners that may be in the picture without being in the way."""
LEVEL, DRAWS = 800, 20
"""Postures with a level hand that are enough to choose from, and the most draws of targets."""
DIGITS = 3
"""Decimals of a pose: a thousandth of a radian or a millimetre is enough for a draft."""


def find_poses(
    finder: PoseFinder, hand: LimbSolver | None, camera: LimbSolver | None
) -> dict[str, FoundPose]:
    """The poses by name.

    hand: brings the grasp frame to poses. camera: brings the camera to them, where the arm
    carries it.
    """
    floor, front = finder.stand.floor, finder.stand.front
    ahead = np.array([front + FLOOR_AHEAD, 0.0, floor])
    table = np.array([front + 0.5, 0.0, floor + TABLE])
    far = np.array([front + AROUND, 0.0, floor + TABLE])
    closed = {**finder.still, **posed(finder.arm.hand, 1.0)}
    home = _folded_low(finder, closed, ahead)
    if camera is None:
        ready = _raised_or_folded(finder, home, closed, table)
        around = _raised_or_folded(finder, home, closed, far)
    else:
        ready = _view(finder, camera, closed, table, 0.9) or home
        around = _view(finder, camera, closed, far, 1.2) or home
    tipped = home if hand is None else replace(home, notes=(*home.notes, TIPS))
    carry = _carry(finder, hand, ahead) or tipped
    found = {"home": home, "ready": ready, "carry": carry, "look_around": around}
    return {name: _finished(finder, pose) for name, pose in found.items()}


def fold_others(
    body: Body, limbs: Limbs, stand: Stand, pairs: Sequence[tuple[str, str]], seed: int
) -> dict[str, float]:
    """Joints of the arms that skills do not use, folded on their own side of the robot."""
    folded: dict[str, float] = {}
    for other in limbs.others:
        if not other.joints:
            continue
        rest = tuple(name for limb in (limbs.arm, *limbs.others) if limb for name in limb.joints)
        held = tuple(name for name in rest if name not in other.joints)
        finder = PoseFinder(
            body, Limbs(other, (), None, (*limbs.rest, *held)), stand, pairs, None, seed, folded
        )
        side = float(np.sign(body.link_poses({}, [other.tip])[other.tip][1, 3]))
        closed = {**finder.still, **posed(other.hand, 1.0)}
        posture, _ = finder.folded(partial(_on_its_side, finder, side), closed)
        folded |= {name: posture[name] for name in other.joints}
    return folded


def _folded_low(finder: PoseFinder, closed: dict[str, float], ahead: np.ndarray) -> FoundPose:
    """Folded with the arm's lift as low as it can be without a collision."""
    low = _fold(finder, {**closed, **finder.lifted(LOW)}, ahead)
    if not finder.lifted(LOW) or (low.clear is not None and low.outside < FAR_OUT):
        return low
    higher = (_fold(finder, {**closed, **finder.lifted(share)}, ahead) for share in RAISED)
    if low.clear is None:
        return next((pose for pose in higher if pose.clear is not None), low)
    best = min((p for p in higher if p.clear is not None), key=lambda p: p.outside, default=low)
    return best if best.outside < low.outside - FAR_OUT / 2 else low


def _on_its_side(finder: PoseFinder, side: float, posture: Mapping[str, float]) -> float:
    """The cost of a folded arm: m out of the footprint, and over the middle of the robot."""
    corners = finder.corners(posture)
    across = np.maximum(0.0, -side * corners[:, 1])
    return 2 * finder.outside(corners) + 4 * float(across.mean() + across.max())


def _fold(
    finder: PoseFinder, fixed: dict[str, float], target: np.ndarray, out: float = OUT
) -> FoundPose:
    fixed = finder.aimed(dict(fixed), target)
    eye_in_hand = finder.eye is not None and finder.eye.in_hand

    def cost(posture: Mapping[str, float]) -> float:
        corners = finder.corners(posture)
        low = 0.2 * float(corners[:, 2].mean() - finder.stand.floor)
        aside = 0.15 * finder.aside(posture, target) if eye_in_hand else 0.0
        return out * finder.outside(corners) + low + finder.covered(posture, corners) + aside

    posture, margin = finder.folded(cost, fixed)
    notes = () if margin is not None else ("no posture without self-collision was found",)
    return _pose(finder, posture, margin, notes)


def _raised_or_folded(
    finder: PoseFinder, home: FoundPose, closed: dict[str, float], target: np.ndarray
) -> FoundPose:
    """The arm out of the picture, its lift as high as it can be without a collision.

    An arm that does not fold so stays over the footprint: the robot is near a table. One that is
    still in the way stays further down.
    """
    lifts = bool(finder.lifted(HIGH))
    shares = (HIGH, *reversed(RAISED)) if lifts else (HIGH,)
    for share in shares:
        raised = _raised(finder, home, target, share)
        if raised is not None:
            return raised
    folded = list[FoundPose]()
    for share in (*shares, LOW) if lifts else shares:
        fixed = {**closed, **finder.lifted(share)}
        folded.append(_fold(finder, fixed, target, BESIDE))
        found = folded[-1]
        if found.clear and found.outside < FAR_OUT / 2 and found.covered < GLIMPSE:
            return found
    clear = [pose for pose in folded if pose.clear is not None]
    return min(clear, key=lambda p: BESIDE * p.outside + p.covered, default=folded[0])


def _raised(
    finder: PoseFinder, home: FoundPose, target: np.ndarray, share: float
) -> FoundPose | None:
    """The arm folded as in `home` but raised, with the head turned to a point; None if not free."""
    posture = finder.aimed({**home.joints, **finder.lifted(share)}, target)
    if home.clear is None or not finder.clear(posture, home.clear):
        return None
    if finder.covered(posture, finder.corners(posture)) > 0:
        return None
    return _pose(finder, posture, home.clear)


def _view(
    finder: PoseFinder,
    camera: LimbSolver,
    fixed: dict[str, float],
    target: np.ndarray,
    height: float,
) -> FoundPose | None:
    """The arm holds the camera so that it looks at a point, from as near to `height` as it can."""
    floor, front = finder.stand.floor, finder.stand.front
    draws = finder.random.uniform((-0.3, -0.15, 0.4), (0.2, 0.15, 1.4), (TARGETS, 3))
    eyes = draws + np.array([front, 0.0, floor])
    eyes[:, 0] = np.minimum(eyes[:, 0], target[0] - 0.25)
    views = [looking(eye, target) for eye in eyes]

    def cost(posture: Mapping[str, float]) -> float:
        off = abs(float(finder.optical(posture).position[2]) - floor - height)
        return off + finder.outside(finder.corners(posture))

    found = finder.solved(camera, views, fixed, cost)
    return None if found is None else _pose(finder, *found)


def _carry(finder: PoseFinder, hand: LimbSolver | None, ahead: np.ndarray) -> FoundPose | None:
    """The hand level, with the held object inside the footprint as far as possible."""
    if hand is None:
        return None
    floor, front, half = finder.stand.floor, finder.stand.front, finder.stand.width / 2
    low = (front - 0.35, -half, 0.45)
    fixed = finder.aimed({**finder.still, **posed(finder.arm.hand, 0.4)}, ahead)

    def targets() -> Iterator[Transform]:
        places = finder.random.uniform(low, (front + 0.3, half, 1.1), (2 * TARGETS, 3))
        yaws = finder.random.uniform(-math.pi, math.pi, 2 * TARGETS)
        for i, ((x, y, z), yaw) in enumerate(zip(places, yaws, strict=True)):
            yield Transform.from_rpy((x, y, z + floor), (math.pi * (i % 2), 0.0, yaw))

    def cost(posture: Mapping[str, float]) -> float:
        corners = finder.corners(posture)
        crowded = CROWDED * finder.crowded(posture, hand.place(posture))
        return 2 * finder.outside(corners, HELD) + finder.covered(posture, corners) + crowded

    found: list[dict[str, float]] = []
    for _ in range(DRAWS):
        found += finder.reached(hand, targets(), fixed)
        if len(found) >= LEVEL:
            break
    best = finder.cheapest(found, cost)
    if best is None and found:  # parts of a wrist may always be near each other in a level hand
        finder = finder.allowing(found)
        best = finder.cheapest(found, cost)
    return None if best is None else _pose(finder, *best)


def _pose(
    finder: PoseFinder,
    posture: dict[str, float],
    margin: float | None,
    notes: tuple[str, ...] = (),
) -> FoundPose:
    corners = finder.corners(posture)
    return FoundPose(
        posture, finder.outside(corners), finder.covered(posture, corners), margin, notes
    )


def _finished(finder: PoseFinder, pose: FoundPose) -> FoundPose:
    """The joints that a named pose gives, in the order of arm, head and the rest."""
    head = finder.limbs.head.joints if finder.limbs.head else ()
    wanted = (*finder.arm.joints, *head, *finder.still)
    joints = {}
    for name in wanted:
        low, high = short_range(finder.body.skeleton.joints[name])
        value = pose.joints.get(name, finder.body.rest()[name])
        joints[name] = round(min(max(round(value, DIGITS), low), high), 5) + 0.0
    return FoundPose(joints, pose.outside, pose.covered, pose.clear, pose.notes)
