"""Choosing where and how to place the held object, and planning the motions for it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Pose, Transform, quaternion_from_axis_angle
from momantu_bt.messages import JointTrajectory
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.resting import UPRIGHT, lies, rise

YAWS = 16
"""Number of yaw angles in which an object may be placed."""
SEEDS = 6
"""Start postures of the inverse kinematics per candidate."""
STARTS = 24
"""The same for an arm with few joints, of which several make up for each other."""
POSTURES = 2
"""Postures kept per candidate, those that are quickest to reach."""
ENOUGH = 4
"""Candidates for which a path is searched."""
TESTED = 900
"""Most postures for which lowering and retreat are checked."""
DROP = 0.006
"""Height above the measured surface at which a hand without force sensor releases, m: such a fall
topples nothing, and a surface that is this much higher is not pressed hard."""
ROLLS = (0.0, math.radians(35), -math.radians(35))
"""How far a lying object may be rolled about its axis before it is set down, rad: it lies alike,
and the hand comes down another way."""
ROLL_PENALTY = 1.0
"""Cost of that, s: the hand comes nearer to the surface."""
SPOT_PENALTY = 0.5
"""Cost per rank of a spot, s: the first spots are the better ones."""


@dataclass(frozen=True, eq=False)
class PlacePlan:
    """The motions for placing. odom_from_object: where the object will stand or lie.

    lower: down past the surface, for a hand with force sensor; blind: to just above the surface,
    for other hands.
    """

    odom_from_object: Transform
    transit: list[JointTrajectory]
    lower: JointTrajectory
    blind: JointTrajectory
    retreat: Transform


@dataclass(frozen=True, eq=False)
class _Candidate:
    odom_from_object: Transform
    lower: Array
    cost: float


def plan_place(
    arm: Arm, held: HeldObject, spots: Sequence[Pose], upright: bool = False
) -> PlacePlan:
    """Choose a spot and a yaw; plan the path above the spot and the path down.

    The object is set down as it rested when it was seen; upright: it is made to stand.

    Raises:
        Failure: NO_PLACE_POSE if the hand cannot place it like that on any spot, NO_PLAN if no
            path leads above the spots where it could, START_IN_COLLISION.
    """
    candidates = _feasible(arm, held, spots, upright)
    transit = arm.route([c.lower[0] for c in candidates], held)
    end = transit[-1].positions[-1] if transit else arm.joints
    best = min(candidates, key=lambda c: float(np.abs(arm.turned(c.lower[0], end) - end).max()))
    lower = arm.turned(best.lower, end)
    return PlacePlan(
        best.odom_from_object,
        transit,
        arm.trajectory(lower, arm.hand.lower_speed),
        arm.trajectory(_blind(arm, lower), arm.hand.lower_speed),
        retreat_of(arm, held),
    )


def retreat_of(arm: Arm, held: HeldObject) -> Transform:
    """tip_from_retreated: back along the fingers, clear of the placed object."""
    return Transform((-arm.hand.approach, 0.0, 0.0))


def _feasible(arm: Arm, held: HeldObject, spots: Sequence[Pose], upright: bool) -> list[_Candidate]:
    postures = list(islice(_postures(arm, held, spots, upright), TESTED))
    for supposed in arm.stages:
        found, lost = _possible(arm, held, postures, supposed)
        if found:
            return found
    where = ", ".join(f"{n} at {what}" for what, n in lost.items() if n)
    how = "lying" if lies(held.object) and not upright else "upright"
    raise Failure(
        "NO_PLACE_POSE",
        f"the hand can set the {held.object.category} down {how} on none of {len(spots)} "
        f"spots: {where or 'no posture of the arm reaches them'}",
        **lost,
    )


def _possible(
    arm: Arm,
    held: HeldObject,
    postures: Sequence[tuple[Transform, Array, float]],
    supposed: float | None,
) -> tuple[list[_Candidate], dict[str, int]]:
    """The best postures that are possible, and how many failed at each step.

    supposed: see `Scene.world`.
    """
    state, margin = arm.state, arm.hand.near_margin
    carrying = arm.scene.world(state, held, margin, held_on_support=True, supposed=supposed)
    opened = arm.scene.world(state, None, margin, width=arm.open_width, supposed=supposed)
    lost = {"collides": 0, "lowering": 0, "retreat": 0}
    found: list[_Candidate] = []
    for pose, q, cost in postures:
        if len(found) >= ENOUGH:
            break
        if not carrying.free(q):
            lost["collides"] += 1
            continue
        lower = _lowering(arm, q)
        at_spot = None if lower is None else lower[: _steps(arm.hand.above, arm) + 1]
        if lower is None or at_spot is None or not carrying.path_free(at_spot):
            lost["lowering"] += 1
            continue
        back = arm.line(at_spot[-1], arm.group.tip_pose(at_spot[-1]) @ retreat_of(arm, held))
        if back is None or not opened.path_free(back[1:]):
            lost["retreat"] += 1
            continue
        found.append(_Candidate(pose, lower, cost))
    return found, lost


def _postures(
    arm: Arm, held: HeldObject, spots: Sequence[Pose], upright: bool
) -> Iterator[tuple[Transform, Array, float]]:
    """(odom_from_object, joints above it (n,), cost in s), cheapest first."""
    state, start, group = arm.state, arm.joints, arm.group
    base_from_odom = state.odom_from_base.inverse()
    object_from_tip = (arm.scene.model.tip_from_grasp @ held.grasp_from_object).inverse()
    poses, penalties = [], []
    for rank, spot in enumerate(spots):
        for pose, penalty in _resting(spot, held, upright):
            poses.append(pose)
            penalties.append(SPOT_PENALTY * rank + penalty)
    above = Transform((0.0, 0.0, arm.hand.above))
    targets = [(base_from_odom @ above @ pose @ object_from_tip).matrix for pose in poses]
    seeds = arm.seeds(start, STARTS if group.few else SEEDS)
    if group.few:
        centres = np.array([(base_from_odom @ pose).position for pose in poses])
        found, good = group.solve_upright(np.array(targets), centres, seeds, math.pi / YAWS)
    else:
        found, good = group.solve(np.array(targets), seeds)
    ranked: list[tuple[float, int, Array]] = []
    for i, penalty in enumerate(penalties):
        solved = group.nearest_turn(found[i][good[i]], start)
        costs = np.max(np.abs(solved - start) / group.velocity, axis=1) + penalty
        for j in np.argsort(costs, kind="stable")[:POSTURES]:
            ranked.append((float(costs[j]), i, solved[j]))
    ranked.sort(key=lambda item: (item[0], item[1]))
    for cost, i, q in ranked:
        yield poses[i] if not group.few else _as_held(arm, object_from_tip, q), q, cost


def _as_held(arm: Arm, object_from_tip: Transform, q: Array) -> Transform:
    """odom_from_object on the spot above which the arm holds it at joints (n,)."""
    above = Transform((0.0, 0.0, -arm.hand.above))
    return arm.state.odom_from_base @ above @ arm.group.tip_pose(q) @ object_from_tip.inverse()


def _resting(spot: Pose, held: HeldObject, upright: bool) -> Iterator[tuple[Transform, float]]:
    """odom_from_object on a spot, with a cost in s, for all yaws: as it rested, or upright."""
    thing, seen = held.object, held.object.pose.transform
    as_it_was = seen.rotation[2, 2] < UPRIGHT and not upright
    for i in range(YAWS):
        standing = _standing(spot, held, 2 * math.pi * i / YAWS)
        if not as_it_was:
            yield standing, 0.0
            continue
        x, y, _ = standing.position
        for roll in ROLLS if lies(thing) else ROLLS[:1]:
            turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), roll)
            rest = Transform((0.0, 0.0, 0.0), seen.quaternion) @ Transform((0.0, 0.0, 0.0), turn)
            rest = Transform((0.0, 0.0, 0.0), standing.quaternion) @ rest
            z = spot.position[2] + rise(thing, rest)
            yield Transform((x, y, z), rest.quaternion), ROLL_PENALTY * abs(roll)


def _standing(spot: Pose, held: HeldObject, yaw: float) -> Transform:
    """odom_from_object with the object upright on a spot, at a yaw of `yaw`."""
    x, y, z = spot.position
    turn = yaw + spot.transform.yaw
    return Transform(
        (x, y, z + held.object.size[2] / 2), (math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
    )


def _lowering(arm: Arm, q: Array) -> Array | None:
    """Joints (k, n) straight down from above the spot to where lowering gives up."""
    tip = arm.group.tip_pose(q)
    depth = arm.hand.above + arm.hand.below
    return arm.line(q, Transform(tip.position - (0.0, 0.0, depth), tip.quaternion))


def _blind(arm: Arm, lower: Array) -> Array:
    """Joints (k, n) of the part of a lowering that ends `DROP` above the spot."""
    path = arm.group.poses(lower)[:, 2, 3]
    whole = int(np.searchsorted(path[0] - path, arm.hand.above - DROP, side="right"))
    share = (path[whole - 1] - path[0] + arm.hand.above - DROP) / (path[whole - 1] - path[whole])
    return np.vstack([lower[:whole], lower[whole - 1] + share * (lower[whole] - lower[whole - 1])])


def _steps(distance: float, arm: Arm) -> int:
    """Points of a lowering path within `distance` m of its start."""
    depth = arm.hand.above + arm.hand.below
    count = math.ceil(depth / arm.hand.linear_step)
    return math.floor(distance / (depth / count))
