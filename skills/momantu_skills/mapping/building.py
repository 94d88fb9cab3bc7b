"""From the scans of a log to a floor plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.occupancy import floor_plan
from momantu_skills.mapping.results import report_of, write_folder
from momantu_skills.mapping.stored import packed
from momantu_skills.mapping.survey import Survey

FEWEST = 2
"""Fewest scans of a map."""


@dataclass(frozen=True, slots=True, eq=False)
class Built:
    """A map. poses: `map_from_base` of the scans at `stamps`. interrupted: it ends early.

    survey: what it was made of, with its last loops.
    """

    plan: MapPicture
    stamps: tuple[float, ...]
    poses: tuple[Pose2D, ...]
    report: dict[str, Any]
    interrupted: bool
    survey: Survey


def build(
    scans: Sequence[LoggedScan],
    resolution: float,
    progress: Callable[[int, int], bool],
    survey: Survey | None = None,
) -> Built:
    """Map scans, oldest first.

    progress: told how many scans are done and how many loops are closed; if it returns True, the
    mapping ends there. survey: what they are added to.
    """
    known = survey or Survey()
    before = len(known.read)
    mapped(known, scans, progress)
    return built_of(known, resolution, interrupted=len(known.read) - before < len(scans))


def mapped(
    survey: Survey, scans: Sequence[LoggedScan], progress: Callable[[int, int], bool]
) -> Survey:
    """Add scans to a survey, until the progress ends it; returns it."""
    for done, scan in enumerate(scans, 1):
        survey.add(scan)
        if progress(done, len(survey.mapper.loops)):
            break
    return survey


def built_of(
    survey: Survey, resolution: float, *, interrupted: bool = False, stands: float = 0.0
) -> Built:
    """The map of a survey, which can go on. stands: radius of the base, m, if it is known."""
    ended = survey.finished()
    mapper = ended.mapper
    plan = floor_plan(ended.placed(), resolution, mapper.config.matching.longest, stands)
    report = report_of(plan, mapper.graph())
    stamps, poses = zip(*ended.trajectory(), strict=True)
    told = {"scans_read": len(survey.read), **report}
    return Built(plan, stamps, poses, told, interrupted, ended)


def write(folder: Path, built: Built, names: Names | None = None) -> None:
    """Write a map's folder, whole or not at all; a map that was there is replaced then.

    names: what the robot was taught; by default nothing but where the map begins.

    Raises:
        OutputError: the folder cannot be written.
    """
    survey = packed(built.survey.known())
    write_folder(folder, built.plan, built.stamps, built.poses, built.report, survey, names)
