"""Looking first at parts of the arm's way that no picture has shown.

The scene treats space that was not seen as free. Near furniture that is often wrong: a narrow view
may miss objects at a table's end, or the cupboard beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory
from momantu_bt.skill import Compute, compute
from momantu_skills.gaze.look_at import look_at
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.scene.surroundings import Support, within

FURTHER = 2
"""Most additional views per path; what is still unseen after them is accepted."""
TALL = 0.3
"""Height above a surface up to which objects may stand that the hand could knock over, m."""
BESIDE = 0.15
"""Distance along the floor to a mapped obstacle within which the hand may hit it, m: half a hand's
width, plus the usual displacement of furniture. Maps do not contain heights. High above a surface,
and this far inside its edges, the hand hits nothing, but a wall may stand at an edge."""
BEHIND = (0.0, 0.08)
"""Distances behind the centre between the pads, m: the points of the hand that are checked."""
EVERY = 4
"""Every n-th posture of a trajectory is checked: about every 0.16 s."""
STAYED = 0.02
"""Largest motion of the arm since planning after which a plan is still valid, rad or m."""
ALONG = 3
"""Number of unseen points on the hand's path that justify a view: one may be noise."""
OVER = 1
"""The same for a path of which only what is over surfaces counts, which is seldom unseen."""
LOW = 2
"""Number of checked postures with a link unseen over a surface that justify a view: links are
longer than the hand, and one of them may be unseen where it begins."""


P = TypeVar("P")


def planned_in_sight(
    arm: Arm,
    plan: Callable[[], P],
    way: Callable[[P], Sequence[JointTrajectory]],
    thinking: float,
    *,
    walls: bool = True,
) -> Generator[str | Compute, Any, P]:
    """A plan whose unseen parts were looked at, as far as the camera can be turned.

    way: returns a plan's trajectories, in order. thinking: time allowed for one planning, s. walls:
    see `blind_spot`. A camera on the hand is moved to where it sees the path, and the plan begins
    there.
    """
    made: P = yield from compute(plan, thinking)
    for _ in range(FURTHER):
        doubtful = blind_spot(arm, way(made), walls=walls)
        if doubtful is None:
            break
        start, seen = arm.joints, True
        try:
            yield from look_at(arm.skill, arm.robot, doubtful)
        except Failure as failure:
            if failure.code != "OUT_OF_VIEW":
                raise
            if np.abs(arm.joints - start).max() < STAYED:
                break
            seen = False
            yield from arm.settle()
        arm.observe()
        made = yield from compute(plan, thinking)
        if not seen:
            break
    return made


def routed_in_sight(
    arm: Arm, goal: Array, thinking: float
) -> Generator[str | Compute, Any, list[JointTrajectory]]:
    """A way to a posture (n,) with what the hand holds, as in `planned_in_sight`.

    An empty hand looks only where something may stand on a surface: a load is wider than the hand,
    and its arm goes the usual ways beside furniture.

    Raises:
        Failure: NO_PLAN or START_IN_COLLISION.
    """
    held = arm.service.held
    return (
        yield from planned_in_sight(
            arm,
            lambda: arm.route([goal], held),
            lambda way: way,
            thinking,
            walls=held is not None,
        )
    )


def blind_spot(arm: Arm, transit: Sequence[JointTrajectory], *, walls: bool = True) -> Array | None:
    """The middle (3,), in odom, of an unseen part of the path over surfaces or near obstacles.

    None if there is no such part. Over surfaces hand, wrist and forearm count: any of them knocks
    over what stands there. walls: the hand counts also beside what the map knows, where furniture
    may have been moved.
    """
    postures = [q for trajectory in transit for q in trajectory.positions[::EVERY]]
    if not postures:
        return None
    spot = _of_hand(arm, postures, walls=walls)
    return _of_links(arm, postures) if spot is None else spot


def _of_hand(arm: Arm, postures: Sequence[Array], *, walls: bool) -> Array | None:
    """See `blind_spot`: of the hand's points."""
    points = _hand_along(arm, postures)
    low, inner = _low(arm, points), np.zeros(len(points), dtype=np.bool_)
    least = OVER
    if walls:
        for support in _supports(arm):
            above = points[:, 2] > support.height
            inner |= within(points[:, :2], support.outline, -BESIDE) & above
        low |= ~inner & (arm.service.floor_plan.distance(points) < BESIDE)
        least = ALONG
    doubtful = points[low & ~arm.scene.seen_space.show(points)]
    return None if len(doubtful) < least else np.asarray(doubtful[len(doubtful) // 2])


def _of_links(arm: Arm, postures: Sequence[Array]) -> Array | None:
    """See `blind_spot`: of wrist, forearm and what else the arm moves, over surfaces."""
    corners = arm.scene.own.along(arm.state, postures)
    unseen = _low(arm, corners.reshape(-1, 3))
    unseen[unseen] = ~arm.scene.seen_space.show(corners.reshape(-1, 3)[unseen])
    unseen = unseen.reshape(corners.shape[:2])
    doubtful = np.flatnonzero(unseen.any(axis=1))
    if len(doubtful) < LOW:
        return None
    middle = doubtful[len(doubtful) // 2]
    return np.asarray(corners[middle][unseen[middle]].mean(axis=0))


def _supports(arm: Arm) -> Iterable[Support]:
    return (*arm.scene.surroundings.supports, *arm.scene.known)


def _low(arm: Arm, points: Array) -> NDArray[np.bool_]:
    """Which points (n, 3), odom, are where something may stand on a surface: (n,)."""
    low = np.zeros(len(points), dtype=np.bool_)
    for support in _supports(arm):
        above = points[:, 2] - support.height
        near = np.flatnonzero((above > 0.0) & (above < TALL))
        low[near] |= within(points[near, :2], support.outline)
    return low


def _hand_along(arm: Arm, postures: Sequence[Array]) -> Array:
    """Points (n, 3) of the hand at some postures, odom, m."""
    odom_from_base, tip_from_grasp = arm.state.odom_from_base, arm.scene.model.tip_from_grasp
    own = np.array([(-behind, 0.0, 0.0) for behind in BEHIND])
    points = [
        (odom_from_base @ arm.group.tip_pose(q) @ tip_from_grasp).apply(own) for q in postures
    ]
    return np.concatenate(points)
