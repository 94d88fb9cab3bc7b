"""Looking first at parts of the hand's path that no picture has shown.

The scene treats space that was not seen as free. Near furniture that is often wrong: a narrow view
may miss objects at a table's end, or the cupboard beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import Any, TypeVar

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory
from momantu_bt.skill import Compute, compute
from momantu_skills.gaze.look_at import look_at
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.scene.surroundings import within

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
"""Every n-th point of a trajectory is checked: about every 0.16 s."""
STAYED = 0.02
"""Largest motion of the arm since planning after which a plan is still valid, rad or m."""
ALONG = 3
"""Number of unseen points on the hand's path that justify a view: one may be noise."""


P = TypeVar("P")


def planned_in_sight(
    arm: Arm,
    plan: Callable[[], P],
    way: Callable[[P], Sequence[JointTrajectory]],
    thinking: float,
) -> Generator[str | Compute, Any, P]:
    """A plan whose unseen parts were looked at, as far as the camera can be turned.

    way: returns a plan's trajectories, in order. thinking: time allowed for one planning, s. A
    camera on the hand is moved to where it sees the path, and the plan begins there.
    """
    made: P = yield from compute(plan, thinking)
    for _ in range(FURTHER):
        doubtful = blind_spot(arm, way(made))
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

    Raises:
        Failure: NO_PLAN or START_IN_COLLISION.
    """
    held = arm.service.held
    return (
        yield from planned_in_sight(arm, lambda: arm.route([goal], held), lambda way: way, thinking)
    )


def blind_spot(arm: Arm, transit: Sequence[JointTrajectory]) -> Array | None:
    """The middle (3,), in odom, of an unseen part of the path over surfaces or near obstacles.

    None if there is no such part.
    """
    points = _hand_along(arm, transit)
    inner, low = np.zeros((2, len(points)), dtype=np.bool_)
    for support in (*arm.scene.surroundings.supports, *arm.scene.known):
        above = points[:, 2] - support.height
        inner |= within(points[:, :2], support.outline, -BESIDE) & (above > 0.0)
        low |= within(points[:, :2], support.outline) & (above > 0.0) & (above < TALL)
    beside = ~inner & (arm.service.floor_plan.distance(points) < BESIDE)
    doubtful = points[(low | beside) & ~arm.scene.seen_space.show(points)]
    return None if len(doubtful) < ALONG else np.asarray(doubtful[len(doubtful) // 2])


def _hand_along(arm: Arm, transit: Sequence[JointTrajectory]) -> Array:
    """Points (n, 3) of the hand along trajectories, odom, m."""
    odom_from_base, tip_from_grasp = arm.state.odom_from_base, arm.scene.model.tip_from_grasp
    own = np.array([(-behind, 0.0, 0.0) for behind in BEHIND])
    points = [
        (odom_from_base @ arm.group.tip_pose(q) @ tip_from_grasp).apply(own)
        for trajectory in transit
        for q in trajectory.positions[::EVERY]
    ]
    return np.concatenate(points) if points else np.empty((0, 3))
