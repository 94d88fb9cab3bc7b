"""Inverse kinematics of a limb, from the URDF alone."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence

import numpy as np

from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import JointLimit
from momantu_skills.manipulation.model.group import Group, chain_group


class LimbSolver:
    """Finds joints of a limb that bring a frame on it to a pose in the base."""

    def __init__(
        self,
        kinematics: KinematicTree,
        joints: Sequence[str],
        limits: Mapping[str, JointLimit],
        link: str,
        link_from_frame: Transform,
        seed: int,
        *,
        upright: bool = True,
    ) -> None:
        """joints: of the limb. link_from_frame: what is brought to poses, on a link.

        upright: whether a limb with few joints may turn the frame about the vertical, as a hand.
        """
        self.upright = upright
        group = chain_group(kinematics, joints, link, limits)
        self.group: Group = dataclasses.replace(group, tip=group.tip @ link_from_frame.matrix)
        self.random = np.random.default_rng(seed)

    def solve(self, base_from_frame: Transform, seeds: int) -> list[dict[str, float]]:
        """Different joints that reach a pose, from so many random starts."""
        found, good = self._solve(base_from_frame.matrix[None], self.starts(seeds))
        postures: list[Array] = []
        for q in found[0][good[0]]:
            if not any(np.abs(q - other).max() < 0.05 for other in postures):
                postures.append(q)
        return [self.named(q) for q in postures]

    def reaches(self, poses: Array, seeds: int, turn: float = math.inf) -> Array:
        """(m,) which of poses (m, 4, 4) are reached from any of so many random starts.

        turn: about the vertical, rad, by which a limb with few joints may miss them.
        """
        return np.asarray(self._solve(poses, self.starts(seeds), turn)[1].any(axis=1))

    def _solve(self, poses: Array, starts: Array, turn: float = math.inf) -> tuple[Array, Array]:
        if self.upright and self.group.few:
            return self.group.solve_upright(poses, poses[:, :3, 3], starts, turn)
        return self.group.solve(poses, starts)

    def place(self, posture: Mapping[str, float]) -> Transform:
        """base_from_frame in a posture."""
        return self.group.tip_pose(np.array([posture[name] for name in self.group.names]))

    def starts(self, count: int) -> Array:
        """Random joints (count, n) within the limits."""
        lower = np.where(self.group.endless, -np.pi, self.group.lower)
        upper = np.where(self.group.endless, np.pi, self.group.upper)
        return np.asarray(self.random.uniform(lower, upper, (count, len(lower))))

    def named(self, q: Array) -> dict[str, float]:
        """Joints (n,) by name, endless ones within half a turn."""
        turned = np.where(self.group.endless, (q + np.pi) % (2 * np.pi) - np.pi, q)
        return {name: float(v) for name, v in zip(self.group.names, turned, strict=True)}
