"""A recorded log: what the laser saw, and where odometry believed the base to be."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from momantu_bt.errors import InputError
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, show
from momantu_bt.geometry import Pose2D
from momantu_skills.navigation.map.sensing import Rays


class LogError(InputError):
    """A log cannot be used; the message has the line, and what would be right."""

    @classmethod
    def at(cls, path: Path, line: int, message: str, hint: str = "") -> LogError:
        """The error for one line, from 1."""
        said = show(Problem("", message, Place(str(path), line)), {})
        return cls(f"{said}\n  {hint}" if hint else said)


@dataclass(frozen=True, slots=True, eq=False)
class LoggedScan:
    """One scan. stamp: s, by the log's clock; rays: in base."""

    stamp: float
    odom_from_base: Pose2D
    rays: Rays


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """The scans of a log, oldest first. notes: what was left out, in sentences."""

    scans: tuple[LoggedScan, ...]
    notes: tuple[str, ...] = field(default=())
