"""Declare the interface of object detectors, and find those that are installed, by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from momantu_bt.errors import MomantuError
from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.plugins import Group, PluginError
from momantu_bt.service import Snapshot


class DetectorError(MomantuError):
    """A detector fails, whatever the picture shows.

    code: what the skill that asks it fails with; it must be one that this skill declares.
    """

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code


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
    search. It may have an attribute `categories`, the categories that it tells apart; the checker
    then warns of others. It may have an attribute `sure`, a score of at least `accepted`: a match
    with a lower one does not end the search, and counts if no look shows a better one.
    """

    @property
    def accepted(self) -> float:
        """Least score at which an object is the requested one."""
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
        the stamp of a view. None if no view shows such a surface.

        Raises:
            DetectorError: it cannot look, whatever the views show.
        """
        ...


def _objection(name: str, plugin: Any) -> str | None:
    lacking = [part for part in ("accepted", "budget", "detect") if not hasattr(plugin, part)]
    if lacking:
        return f"{plugin!r} has no {' and no '.join(lacking)}; see momantu_bt.detector"
    return None if callable(plugin) else f"{plugin!r} is not a class"


DETECTORS: Group[Callable[[], ObjectDetector]] = Group(
    "momantu_bt.detectors", "detector", _objection
)
"""Classes of detectors, by the names that trees give."""


def known_categories() -> tuple[str, ...] | None:
    """The categories that the installed detectors know; None if one of them does not say."""
    known: list[str] = []
    for name in DETECTORS:
        try:
            categories = getattr(DETECTORS[name], "categories", None)
        except PluginError:
            continue
        if categories is None:
            return None
        known += [category for category in categories if category not in known]
    return tuple(known) or None
