"""The detectors that are installed, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from momantu_bt.detector import ObjectDetector
from momantu_bt.plugins import Group


def _objection(name: str, plugin: Any) -> str | None:
    lacking = [part for part in ("accepted", "budget", "detect") if not hasattr(plugin, part)]
    if lacking:
        return f"{plugin!r} has no {' and no '.join(lacking)}; see momantu_bt.detector"
    return None if callable(plugin) else f"{plugin!r} is not a class"


DETECTORS: Group[Callable[[], ObjectDetector]] = Group(
    "momantu_bt.detectors", "detector", _objection
)
