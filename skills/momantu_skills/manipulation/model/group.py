"""A planning group: a chain of joints from the base to a tip, its kinematics and limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from momantu_bt.frames import Joint, KinematicTree
from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import JointLimit
from momantu_skills.manipulation.model import kinematics as kin

PACE = 1.5
"""Speed of a usual arm's joints, rad/s; the joints of a group are scaled relative to it."""
JUMP = 0.25
"""Largest joint motion between two solutions 1 cm apart on a straight line, rad; more means another
arm configuration."""
RANKED = 8
"""Random postures in which the freedoms of a chain are counted."""
SINGULAR = 1e-3
"""Least singular value of a Jacobian, m or rad per rad or m, that counts as a freedom."""
SPREAD = 0.618
"""Step between the turns from which a free turn starts, as a share of all (the golden ratio)."""
NEAR, TURN = 5e-4, 3e-3
"""Tolerances of inverse kinematics, m and rad: well below calibration errors."""


@dataclass(frozen=True)
class Group:
    """A chain of n joints from the base to a tip, with limits (endless joints: infinite).

    scale (n,): converts joint angles to equal times. For the other fields see `kinematics`.
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    origins: Array
    axes: Array
    slides: NDArray[np.bool_]
    tip: Array

    @property
    def pace(self) -> float:
        """Speed in rad/s: a scaled radian takes 1 / pace s on each joint. Less on a slow arm."""
        return min(PACE, float(np.median(self.velocity)))

    @property
    def scale(self) -> Array:
        """Scaled radians per radian or metre, (n,)."""
        return self.pace / self.velocity

    @property
    def endless(self) -> NDArray[np.bool_]:
        """Which joints (n,) can turn without limit."""
        return np.asarray(~np.isfinite(self.lower))

    @cached_property
    def chain(self) -> kin.Chain:
        """The joints in the form that the compiled kinematics take."""
        weights = (self.velocity / self.pace) ** 2
        limits = (self.lower, self.upper)
        return kin.Chain(self.origins, self.axes, self.slides, self.tip, *limits, weights)

    def tip_pose(self, q: Array) -> Transform:
        """base_from_tip at joints (n,)."""
        r, p, _ = kin.forward(self.chain, q)
        return Transform.from_rotation(r, p)

    def tip_matrix(self, q: Array) -> Array:
        """base_from_tip (4, 4) at joints (n,)."""
        m = np.eye(4)
        m[:3, :3], m[:3, 3], _ = kin.forward(self.chain, q)
        return m

    def jacobian(self, q: Array) -> Array:
        """(6, n): velocity of the tip, then angular velocity, in base, per joint."""
        return np.asarray(kin.forward(self.chain, q)[2])

    def solve(self, targets: Array, seeds: Array, rounds: int = 40) -> tuple[Array, Array]:
        """Inverse kinematics of poses (m, 4, 4) from seeds (s, n).

        Returns joints (m, s, n) within the limits, and success (m, s).
        """
        found, good = kin.solve(
            self.chain, np.ascontiguousarray(targets), seeds, rounds, NEAR, TURN
        )
        return found, good

    def trace(self, targets: Array, start: Array) -> tuple[Array, int]:
        """Joints along poses (k, 4, 4) a centimetre apart: (reached, n), and their number."""
        path, reached = kin.trace(
            self.chain, np.ascontiguousarray(targets), np.array(start), NEAR, TURN, JUMP
        )
        return path[:reached], int(reached)

    @cached_property
    def freedoms(self) -> int:
        """In how many of its six directions and turns the chain moves its tip."""
        lower = np.where(self.endless, -np.pi, self.lower)
        upper = np.where(self.endless, np.pi, self.upper)
        draws = np.random.default_rng(0).uniform(lower, upper, (RANKED, len(lower)))
        return max(int(np.linalg.matrix_rank(self.jacobian(q), tol=SINGULAR)) for q in draws)

    @property
    def few(self) -> bool:
        """Whether it has too few joints to choose the turn of the hand about the vertical."""
        return self.freedoms < 6

    def turning(self, tip_from_axis: Array, limit: float) -> Group:
        """Return the chain with one more joint, a turn of the tip about z of a frame on it.

        A pose that this chain reaches is one of this group's but for such a turn. tip_from_axis:
        (4, 4). limit: rad, infinite for a free turn.
        """
        return replace(
            self,
            names=(*self.names, "turn"),
            lower=np.append(self.lower, -limit),
            upper=np.append(self.upper, limit),
            velocity=np.append(self.velocity, self.velocity.max()),
            acceleration=np.append(self.acceleration, 1.0),
            origins=np.concatenate([self.origins, (self.tip @ tip_from_axis)[None]]),
            axes=np.vstack([self.axes, (0.0, 0.0, 1.0)]),
            slides=np.append(self.slides, False),
            tip=np.asarray(np.linalg.inv(tip_from_axis), dtype=np.float64),
        )

    def solve_upright(
        self, targets: Array, centres: Array, seeds: Array, limit: float, rounds: int = 60
    ) -> tuple[Array, Array]:
        """Inverse kinematics of poses (m, 4, 4) but for a turn about the vertical.

        centres: (m, 3) points in base, or (3,), through which the axes of the turns go. limit: of
        the turns, rad. Returns joints (m, s, n) and success (m, s), as `solve` does.
        """
        found = np.zeros((len(targets), *seeds.shape))
        good = np.zeros(found.shape[:2], dtype=np.bool_)
        spread = 2.0 * ((0.5 + SPREAD * np.arange(len(seeds))) % 1.0) - 1.0
        starts = np.column_stack([seeds, min(limit, np.pi) * spread])
        for i, (target, centre) in enumerate(
            zip(targets, np.broadcast_to(centres, (len(targets), 3)), strict=True)
        ):
            base_from_axis = np.eye(4)
            base_from_axis[:3, 3] = centre
            group = self.turning(np.linalg.inv(target) @ base_from_axis, limit)
            joints, good[i : i + 1] = group.solve(target[None], starts, rounds)
            found[i] = joints[0, :, :-1]
        return found, good

    def trace_upright(
        self, targets: Array, start: Array, tip_from_axis: Array, limit: float
    ) -> tuple[Array, int]:
        """As `trace`, but each pose may be turned by up to `limit` rad about an axis of the tip."""
        group = self.turning(tip_from_axis, limit)
        path, reached = group.trace(targets, np.append(start, 0.0))
        return path[:, :-1], reached

    def poses(self, postures: Array) -> Array:
        """base_from_tip (m, 4, 4) at each of joints (m, n)."""
        return np.asarray(kin.poses(self.chain, postures))

    def point(
        self, starts: Array, ray: Array, target: Array, rounds: int = 12
    ) -> tuple[Array, Array]:
        """Rotate a ray (3,) of the tip towards a point (3,) in base, from joints (m, n).

        Returns joints (m, n) within the limits, with little motion, and the remaining angles (m,),
        rad.
        """
        found, left = kin.point(self.chain, starts, ray, target, rounds, TURN)
        return found, left

    def nearest_turn(self, q: Array, reference: Array) -> Array:
        """The same posture, with endless joints (.., n) within half a turn of `reference` (n,)."""
        turns = np.round((q - reference) / (2 * np.pi)) * (2 * np.pi)
        return np.where(self.endless, q - turns, q)


def chain_group(
    kinematics: KinematicTree,
    names: Sequence[str],
    tip: str,
    joint_limits: Mapping[str, JointLimit],
) -> Group:
    """The chain of those joints in `names` that lead to a link; others on the way stay at 0."""
    joints: list[Joint] = []
    origins: list[Array] = []
    after = np.eye(4)
    for joint in kinematics.chain(tip):
        after = after @ joint.parent_from_joint.matrix
        if joint.name in names:
            joints.append(joint)
            origins.append(after)
            after = np.eye(4)
    limits = [joint_limits[joint.name] for joint in joints]
    axes = np.array([joint.axis for joint in joints])
    return Group(
        names=tuple(joint.name for joint in joints),
        lower=np.array([-np.inf if m.lower is None else m.lower for m in limits]),
        upper=np.array([np.inf if m.upper is None else m.upper for m in limits]),
        velocity=np.array([m.velocity for m in limits]),
        acceleration=np.array([m.acceleration for m in limits]),
        origins=np.ascontiguousarray(origins),
        axes=axes / np.linalg.norm(axes, axis=1, keepdims=True),
        slides=np.array([joint.kind == "prismatic" for joint in joints]),
        tip=after,
    )


def compile_kernels() -> None:
    """Compile `kinematics` into numba's cache: some 10 s once, instead of during a run."""
    eye = np.eye(4)
    group = Group(
        names=("slide", "turn"),
        lower=np.array([0.0, -np.inf]),
        upper=np.array([1.0, np.inf]),
        velocity=np.ones(2),
        acceleration=np.ones(2),
        origins=np.stack([eye, eye]),
        axes=np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]),
        slides=np.array([True, False]),
        tip=eye,
    )
    here = np.array([0.5, 0.0])
    target = group.tip_matrix(here)[None]
    group.solve(target, here[None])
    group.trace(target, here)
