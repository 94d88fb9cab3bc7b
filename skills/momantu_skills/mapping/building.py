"""From the scans of a log to a floor plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Pose2D
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.occupancy import floor_plan
from momantu_skills.mapping.results import report_of
from momantu_skills.mapping.survey import Survey

FEWEST = 2
"""Fewest scans of a map."""


@dataclass(frozen=True, slots=True, eq=False)
class Built:
    """A map. poses: `map_from_base` of the scans at `stamps`. interrupted: it ends early."""

    plan: MapPicture
    stamps: tuple[float, ...]
    poses: tuple[Pose2D, ...]
    report: dict[str, Any]
    interrupted: bool


def build(
    scans: Sequence[LoggedScan], resolution: float, progress: Callable[[int, int], bool]
) -> Built:
    """Map scans, oldest first.

    progress: told how many scans are done and how many loops are closed; if it returns True, the
    mapping ends there.
    """
    survey = Survey()
    for scan in scans:
        survey.add(scan)
        if progress(len(survey.read), len(survey.mapper.loops)):
            break
    return built_of(survey, resolution, interrupted=len(survey.read) < len(scans))


def built_of(
    survey: Survey, resolution: float, *, interrupted: bool = False, stands: float = 0.0
) -> Built:
    """The map of a survey, which can go on. stands: radius of the base, m, if it is known."""
    ended = survey.finished()
    mapper = ended.mapper
    plan = floor_plan(ended.placed(), resolution, mapper.config.matching.longest, stands)
    report = report_of(plan, mapper.poses, len(mapper.loops))
    stamps, poses = zip(*ended.trajectory(), strict=True)
    return Built(plan, stamps, poses, {"scans_read": len(survey.read), **report}, interrupted)
