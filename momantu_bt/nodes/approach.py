"""PathLongerOnApproach: Nav2's guard against a long detour just before the goal."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts
from momantu_bt.engine.status import RUNNING, SUCCESS, Status
from momantu_bt.failure import WRONG_TYPE, Failure
from momantu_bt.geometry import Pose, Pose2D
from momantu_bt.tree.catalogue.flow import perhaps
from momantu_bt.tree.catalogue.spec import Dialect, decorator, input_port


class PathLongerOnApproach(Decorator):
    """Ticks the child while the new path is a long detour; otherwise SUCCESS.

    The new path is compared with the last one. It is a detour when it ends at the same pose but
    differs from the last path, when the last path is shorter than `prox_len`, and when the new one
    is more than `length_factor` times as long. The last path is not replaced while the child runs,
    and it is kept when the node ends or is halted.
    """

    spec = decorator(
        "PathLongerOnApproach",
        "path_longer_on_approach",
        "Runs the child when a new path is much longer than the last, near its end.",
        input_port("path", tuple, "the path: a list of poses"),
        input_port("prox_len", float, "how near: the length of the last path", 3.0, "m", least=0),
        input_port("length_factor", float, "how much longer", 2.0, least=0),
        dialect=Dialect.NAV2,
        flow=perhaps,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.before: tuple[Any, ...] = ()

    def step(self) -> Status:
        """Compare the new path with the last one; tick the child when it is a detour."""
        self.state = RUNNING
        path = tuple(self.inputs["path"])
        if self._is_detour(path):
            status = self.child.execute()
            if status.completed:
                self.before = path
                self.child.reset()
            return self.pass_on(status)
        self.before = path
        return SUCCESS

    def _is_detour(self, path: tuple[Any, ...]) -> bool:
        before = self.before
        if not path or not before or len(path) == len(before):
            return False
        if _place(path[-1]) != _place(before[-1]):
            return False
        short = length(before)
        near: float = self.inputs["prox_len"]
        factor: float = self.inputs["length_factor"]
        return short < near and length(path) > factor * short


def length(path: Sequence[Any]) -> float:
    """The length of a path of poses, m; Failure WRONG_TYPE when they are not poses."""
    points = [_point(pose) for pose in path]
    return math.fsum(math.dist(a, b) for a, b in itertools.pairwise(points))


def _place(pose: Any) -> Any:
    """A pose without its time stamp."""
    return (pose.frame, pose.transform) if isinstance(pose, Pose) else pose


def _point(pose: Any) -> tuple[float, float, float]:
    if isinstance(pose, Pose2D):
        return (pose.x, pose.y, 0.0)
    if isinstance(pose, Pose):
        x, y, z = pose.position
        return (float(x), float(y), float(z))
    raise Failure(WRONG_TYPE, f"path holds {type(pose).__name__}; expected poses", port="path")
