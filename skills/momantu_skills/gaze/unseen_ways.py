"""Looking first where a path of the hand leads through space that no picture has shown.

The scene holds for free what it has not seen. That is wrong often enough where the map knows of
furniture: a narrow view leaves out what stands at a table's end, and the cupboard beside it.
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
"""Looks that a way is worth; what cannot be seen after them stays in doubt."""
TALL = 0.3
"""m above a surface up to which things stand on it that the hand could knock over."""
BESIDE = 0.15
"""m along the floor to what the map knows within which the hand may meet it: half a hand's width,
and what furniture stands beside its place. No map tells how high it is; high above a surface, so
far within its edges, the hand meets nothing, but a wall may stand at an edge."""
BEHIND = (0.0, 0.08)
"""m behind the place between the pads: the points of the hand that are asked about."""
EVERY = 4
"""Points of a trajectory from one that is asked about to the next: about 0.16 s."""
STAYED = 0.02
"""rad or m that the arm may have moved and a plan still begin where it is."""
ALONG = 3
"""Points of the hand's way that must be in doubt to be worth a look: one may be noise."""


P = TypeVar("P")


def planned_in_sight(
    arm: Arm,
    plan: Callable[[], P],
    way: Callable[[P], Sequence[JointTrajectory]],
    thinking: float,
) -> Generator[str | Compute, Any, P]:
    """A plan whose unseen stretches have been looked at, as far as the camera can be turned.

    way: of a plan, one trajectory after the other. thinking: s that one planning is given. A
    camera that the hand carries is brought to where it sees the way, and the plan begins there.
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


def blind_spot(arm: Arm, transit: Sequence[JointTrajectory]) -> Array | None:
    """The middle (3,), in odom, of an unseen stretch over surfaces or near known obstacles.

    None: nowhere.
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
