"""The frames of a log over time: which frame sits on which, and where."""

from __future__ import annotations

from bisect import bisect_right, insort
from dataclasses import dataclass, field

import numpy as np

from momantu_bt.geometry import Transform

LONGEST_GAP = 1.5
"""Time between two transforms that is bridged by an even motion, s."""
STILL = 1e-3
"""Motion below which a frame counts as fixed, m and rad."""


@dataclass(slots=True)
class _Edge:
    """Where a frame sits on its parent: stamps, s, a running number, and `parent_from_child`."""

    parent: str
    poses: list[tuple[float, int, Transform]] = field(default_factory=list)


class Transforms:
    """All transforms of a log. A frame's name counts without a slash before it."""

    def __init__(self) -> None:
        """Know of no frame."""
        self._edges: dict[str, _Edge] = {}
        self._count = 0

    def add(self, parent: str, child: str, stamp: float, pose: Transform) -> None:
        """Enter `parent_from_child` at a time, s; the newest parent of a frame counts."""
        parent, child = plain(parent), plain(child)
        edge = self._edges.get(child)
        if edge is None or edge.parent != parent:
            edge = self._edges[child] = _Edge(parent)
        self._count += 1
        insort(edge.poses, (stamp, self._count, pose), key=lambda each: each[:2])

    def above(self, frame: str) -> list[str]:
        """The frame, its parent, and so on up to a frame that sits on none."""
        chain = [plain(frame)]
        while (edge := self._edges.get(chain[-1])) is not None and edge.parent not in chain:
            chain.append(edge.parent)
        return chain

    def carrier(self, frame: str) -> str:
        """The highest frame on which a frame never moves; itself, if it sits on none."""
        chain = self.above(frame)
        return next((each for each in chain[:-1] if not self.still(each)), chain[-1])

    def in_odometry(self) -> tuple[str, str] | None:
        """The frame of odometry, by its name, and the first one that moves in it; None without."""
        pairs = ((edge.parent, child) for child, edge in self._edges.items())
        return next((pair for pair in pairs if "odom" in pair[0].lower()), None)

    def moved(self, frame: str, stamp: float) -> Transform | None:
        """`parent_from_frame` between two known ones; None outside them and in a long gap."""
        poses = self._edges[plain(frame)].poses
        after = bisect_right(poses, stamp, key=lambda each: each[0])
        if after and poses[after - 1][0] == stamp:
            return poses[after - 1][2]
        if not 0 < after < len(poses):
            return None
        (t0, _, before), (t1, _, later) = poses[after - 1 : after + 1]
        return _between(before, later, (stamp - t0) / (t1 - t0)) if t1 - t0 < LONGEST_GAP else None

    def still(self, frame: str) -> bool:
        """Whether a frame, which sits on another one, never moves on it: by 1 mm and 1 mrad."""
        poses = self._edges[plain(frame)].poses
        first = poses[0][2]
        return all(
            float(np.linalg.norm(pose.position - first.position)) < STILL
            and pose.angle_to(first) < STILL
            for _, _, pose in poses
        )

    def mounted(self, target: str, frame: str, stamp: float) -> Transform:
        """`target_from_frame` as last told at a time; target: the frame, or one above it."""
        found = Transform()
        chain = self.above(frame)
        for each in chain[: chain.index(plain(target))]:
            poses = self._edges[each].poses
            known = max(1, bisect_right(poses, stamp, key=lambda told: told[0]))
            found = poses[known - 1][2] @ found
        return found


def plain(frame: str) -> str:
    """A frame's name as ROS 2 writes it."""
    return frame.lstrip("/")


def _between(before: Transform, later: Transform, share: float) -> Transform:
    """The pose at a share of a short motion: straight, turning evenly."""
    position = (1.0 - share) * before.position + share * later.position
    first, second = before.quaternion, later.quaternion
    if float(first @ second) < 0.0:
        second = -second
    return Transform(position, (1.0 - share) * first + share * second)
