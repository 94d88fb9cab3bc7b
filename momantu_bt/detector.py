"""The interface of object detectors; a skill takes one by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.service import Snapshot


@dataclass(frozen=True, slots=True)
class View:
    """A snapshot and its points (n, 3) in odom, m: near the surface, without the robot itself."""

    snapshot: Snapshot
    points: Array

    @property
    def camera(self) -> Array:
        """The camera's position, (3,) in odom, m."""
        return self.snapshot.odom_from_camera.position


class ObjectDetector(Protocol):
    """Finds objects on a surface.

    Its class is an entry point of `momantu_bt.detectors`, and is made without arguments once per
    search.
    """

    @property
    def accepted(self) -> float:
        """Score from which on an object is the requested one."""
        ...

    @property
    def budget(self) -> float:
        """Simulated time that one call of `detect` takes, s."""
        ...

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...] | None:
        """Everything that stands on the surface between the heights `low` and `high` (m, odom).

        Best score first; a score says how well an object matches `asked`. Poses are in odom, with
        the stamp of a view. None when no view shows such a surface.
        """
        ...
