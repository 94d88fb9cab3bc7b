"""Choosing grasps that can be approached, held and lifted, and planning the motions for one."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice, product

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject, JointTrajectory, RobotState
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.config import Hold
from momantu_skills.manipulation.hand.choosing import Options, options_for
from momantu_skills.manipulation.hand.grasps import Grasp
from momantu_skills.manipulation.hand.resting import lies
from momantu_skills.manipulation.hand.rims import wall_pieces
from momantu_skills.manipulation.hand.sides import Sides, sentence
from momantu_skills.manipulation.hand.underside import low_penalty
from momantu_skills.manipulation.model.collision import CollisionWorld, Obstacle
from momantu_skills.manipulation.model.hulls import object_corners
from momantu_skills.manipulation.scene.scene import Cut

SEEDS = 6
"""Start postures of the inverse kinematics per grasp: they find a solution for three of four
reachable grasps."""
FROM_BEHIND = -0.3
"""Grasps are skipped if the cosine between the fingers' direction and the direction from base to
object is below this: they would reach around the object."""
POSTURES = 3
"""Postures kept per grasp, those that are quickest to reach."""
ENOUGH = 5
"""Grasps for which a path is searched: the planner takes the first that it can reach."""
TESTED = 1800
"""Most postures for which approach and lift are checked."""
CUT = (0.025, 0.025, 0.03)
"""Margin around the object within which cells belong to it, m: detection error and a cell's
diagonal."""
BESIDE = 0.003
"""Clearance between open hand and object until it closes, m: less than the palm's."""
STARTS = 16
"""The same for an arm with few joints, of which several make up for each other."""
SQUARE = 0.05
"""How far an arm with few joints may turn a hand that grasps flat faces, rad."""
ALIKE = 0.05
"""Postures of an arm with few joints within this are the same, rad or m."""
SKIN = 0.004
"""Clearance between hand and object on the way to it, m."""


@dataclass(frozen=True, eq=False)
class Reach:
    """A grasp with its motions: approach (k, n) ends at the grasp, lift (m, n) begins there.

    cut: where cells did not count, as they are the object's.
    """

    grasp: Grasp
    approach: Array
    lift: Array
    cost: float
    cut: Cut


@dataclass(frozen=True, eq=False)
class PickPlan:
    """The motions of a grasp. transit: trajectories to the pre-grasp, one after the other."""

    grasp: Grasp
    transit: list[JointTrajectory]
    approach: JointTrajectory
    retreat: JointTrajectory
    lift: JointTrajectory


def plan_pick(arm: Arm, thing: DetectedObject, lift: float, by: Hold = "any") -> PickPlan:
    """Choose a grasp; plan its approach, its lift and the path to them.

    by: the part that is to be held, see `options_for`.

    Raises:
        Failure: NO_GRASP if no grasp can be reached, NO_PLAN if no path leads to any of those
            that can, START_IN_COLLISION.
    """
    reaches = reachable(arm, thing, lift, by)
    state = arm.state
    base_from_object = state.odom_from_base.inverse() @ thing.pose.transform
    target = Obstacle("target", base_from_object.apply(object_corners(thing, SKIN)))
    goals = [reach.approach[0] for reach in reaches]
    transit = arm.route(goals, None, width=arm.open_width, cut=reaches[0].cut, extra=(target,))
    end = transit[-1].positions[-1] if transit else arm.joints
    reach = min(reaches, key=lambda r: float(np.abs(arm.turned(r.approach[0], end) - end).max()))
    approach, up = arm.turned(reach.approach, end), arm.turned(reach.lift, end)
    return PickPlan(
        reach.grasp,
        transit,
        arm.trajectory(approach, arm.hand.approach_speed),
        arm.trajectory(approach[::-1], arm.hand.lift_speed),
        arm.trajectory(up, arm.hand.lift_speed),
    )


def reachable(arm: Arm, thing: DetectedObject, lift: float, by: Hold = "any") -> list[Reach]:
    """Grasps with possible approach, closing and lift, best first.

    What is assumed behind the object's visible faces counts as an obstacle, unless nothing is left
    then; so does what is supposed of the maps.

    Raises:
        Failure: NO_GRASP, with the number of postures that failed at each step, and why each side
            of the object fell out.
    """
    options = options_for(arm, thing, by)
    grasps = options.grasps
    postures = list(_postures(arm, thing, grasps))[:TESTED]
    for supposed, filled in product(arm.stages, (False, True)):
        cut = Cut(thing.pose.transform, _cut(thing, options), filled)
        check = _Check(arm, thing, lift, cut, supposed, options)
        found = list(islice(filter(None, (check(*posture) for posture in postures)), ENOUGH))
        if found:
            return found
    sides = {**check.sides.told(grasps), **options.missing}
    raise Failure(
        "NO_GRASP",
        f"none of {len(grasps)} grasps can be approached, held and lifted: {sentence(sides)}",
        sides=sides,
        **check.lost,
    )


def _postures(
    arm: Arm, thing: DetectedObject, grasps: Sequence[Grasp]
) -> Iterator[tuple[Grasp, Array, float]]:
    """Postures (n,) at the grasps, with their cost in seconds, cheapest first."""
    state, start, group = arm.state, arm.joints, arm.group
    base_from_object = state.odom_from_base.inverse() @ thing.pose.transform
    grasp_from_tip = arm.scene.model.tip_from_grasp.inverse()
    away = base_from_object.position[:2] / np.linalg.norm(base_from_object.position[:2])
    poses = [base_from_object @ grasp.object_from_grasp for grasp in grasps]
    ahead = [float(pose.rotation[:2, 0] @ away) > FROM_BEHIND for pose in poses]
    grasps = [grasp for grasp, keep in zip(grasps, ahead, strict=True) if keep]
    targets = [(p @ grasp_from_tip).matrix for p, keep in zip(poses, ahead, strict=True) if keep]
    if group.few:
        yield from _upright_postures(arm, thing, grasps, np.array(targets))
        return
    found, good = group.solve(np.array(targets), arm.seeds(start, SEEDS))
    ranked: list[tuple[float, int, Array]] = []
    for i, grasp in enumerate(grasps):
        solved = group.nearest_turn(found[i][good[i]], start)
        costs = np.max(np.abs(solved - start) / group.velocity, axis=1)
        costs += grasp.penalty + arm.carry_penalty(grasp.object_from_grasp.inverse())
        costs += arm.blind_penalty(grasp.object_from_grasp, thing.pose.transform)
        order = np.argsort(costs, kind="stable")[:POSTURES]
        low = low_penalty(arm, thing, solved[order[0]]) if len(order) else 0.0
        ranked += [(float(costs[j]) + low, i, solved[j]) for j in order]
    ranked.sort(key=lambda item: (item[0], item[1]))
    for cost, i, q in ranked:
        yield grasps[i], q, cost


def _upright_postures(
    arm: Arm, thing: DetectedObject, grasps: Sequence[Grasp], targets: Array
) -> Iterator[tuple[Grasp, Array, float]]:
    """The same for an arm with few joints: the hand's turn about the object is what they leave.

    targets: base_from_tip (m, 4, 4) of the grasps. Each grasp is given as the arm takes it.
    """
    start, group = arm.joints, arm.group
    object_from_base = (arm.state.odom_from_base.inverse() @ thing.pose.transform).inverse()
    limit = math.inf if thing.shape == "cylinder" and not lies(thing) else SQUARE
    centre = object_from_base.inverse().position
    found, good = group.solve_upright(targets, centre, arm.seeds(start, STARTS), limit)
    ranked: list[tuple[float, int, Grasp, Array]] = []
    known: set[tuple[int, ...]] = set()
    for i, grasp in enumerate(grasps):
        for q in group.nearest_turn(found[i][good[i]], start):
            key = tuple(int(c) for c in np.rint(q / ALIKE))
            if key in known:
                continue
            known.add(key)
            place = object_from_base @ group.tip_pose(q) @ arm.scene.model.tip_from_grasp
            own = replace(grasp, object_from_grasp=place)
            cost = float(np.max(np.abs(q - start) / group.velocity)) + grasp.penalty
            cost += arm.carry_penalty(place.inverse())
            cost += arm.blind_penalty(place, thing.pose.transform) + low_penalty(arm, thing, q)
            ranked.append((cost, i, own, q))
    ranked.sort(key=lambda item: item[:2])
    for cost, _, own, q in ranked:
        yield own, q, cost


class _Check:
    """Checks hand, approach and lift of a posture at a grasp; counts the failures per step."""

    def __init__(
        self,
        arm: Arm,
        thing: DetectedObject,
        lift: float,
        cut: Cut,
        supposed: float | None,
        options: Options,
    ) -> None:
        self._arm, self._thing, self._lift = arm, thing, lift
        self._state: RobotState = arm.state
        self._cut, self._supposed = cut, supposed
        margin = arm.hand.near_margin
        self._open = arm.scene.world(
            self._state, None, margin, width=arm.open_width, cut=cut, supposed=supposed
        )
        solids = [object_corners(thing)]
        handle = options.handle_corners(thing)
        self._around = {
            "body": _around(arm, self._state, thing, [*solids, *handle]),
            "rim": _around(arm, self._state, thing, [*wall_pieces(thing), *handle]),
            "handle": _around(arm, self._state, thing, solids),
        }
        self.lost = {"hand collides": 0, "approach": 0, "lift": 0}
        self.sides = Sides(arm, thing)

    def __call__(self, grasp: Grasp, q: Array, cost: float) -> Reach | None:
        arm, around = self._arm, self._around[grasp.part]
        if not (self._open.free(q) and around.free(q)):
            self._lost("hand collides", grasp, q, self._open, around)
            return None
        base_from_tip = arm.group.tip_pose(q)
        back = base_from_tip @ Transform((-arm.hand.approach, 0.0, 0.0))
        approach = arm.line(q, back)
        if approach is None or not (self._open.path_free(approach) and around.path_free(approach)):
            self._lost("approach", grasp, q)
            return None
        x, y, z = base_from_tip.position
        above = Transform((x, y, z + self._lift), base_from_tip.quaternion)
        lift = arm.line(q, above)
        if lift is None or not self._carrying(grasp).path_free(lift):
            self._lost("lift", grasp, q)
            return None
        return Reach(grasp, approach[::-1], lift, cost, self._cut)

    def _carrying(self, grasp: Grasp) -> CollisionWorld:
        held = HeldObject(self._thing, grasp.object_from_grasp.inverse())
        return self._arm.scene.world(
            self._state,
            held,
            self._arm.hand.near_margin,
            width=grasp.width,
            held_on_support=True,
            cut=self._cut,
            supposed=self._supposed,
        )

    def _lost(self, step: str, grasp: Grasp, q: Array, *worlds: CollisionWorld) -> None:
        self.lost[step] += 1
        self.sides.lost(grasp, step, q, *worlds)


def _around(
    arm: Arm, state: RobotState, thing: DetectedObject, pieces: Sequence[Array]
) -> CollisionWorld:
    """The object alone, as an obstacle that an open hand must not touch before it closes.

    pieces: corners (n, 3) of each of its convex pieces, in its frame, m.
    """
    base_from_object = state.odom_from_base.inverse() @ thing.pose.transform
    solids = [Obstacle("target", base_from_object.apply(corners)) for corners in pieces]
    posture = arm.scene.model.configuration(state, arm.open_width)
    return CollisionWorld(arm.scene.own.pairs, posture, solids, margin=BESIDE)


def _cut(thing: DetectedObject, options: Options) -> tuple[float, float, float]:
    x, y, z = (edge / 2 + more for edge, more in zip(thing.size, CUT, strict=True))
    if options.handle is not None:
        x = y = max(x, options.handle.outer + CUT[0])
    return x, y, z
