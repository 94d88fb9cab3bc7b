"""Going on with a map that was saved: what it was made of, and where a new session begins on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.failure import Failure
from momantu_bt.formats.map_folder import NAMES
from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names, read_names
from momantu_bt.world import Places, Site, Surfaces
from momantu_skills.mapping import building, results, stored
from momantu_skills.mapping.anchors import Anchors
from momantu_skills.mapping.comparing.align import SURE_SHARE, align, placed
from momantu_skills.mapping.comparing.side import Side
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.occupancy import Occupancy
from momantu_skills.mapping.saved import read_saved
from momantu_skills.mapping.survey import Known, Survey
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.config import MatchingConfig

NEAR = np.array([1.5, 1.0])
"""How far from where it is told that it starts a robot is looked for, m and rad."""
FITS = 0.7
"""Least share of a scan's hits within 10 cm of the map's walls at a place that is believed."""


@dataclass(frozen=True, slots=True, eq=False)
class Earlier:
    """A saved map to go on with. names: those that were taught."""

    folder: Path
    grid: GridMap
    known: Known
    names: Names | None


def read_earlier(folder: Path) -> Earlier:
    """Read a map's folder.

    Raises:
        InputError: there is no map, or not what it was made of; the message says what to do.
        MapError, SiteFileError: a file of it is broken.
    """
    found = read_saved(folder)
    survey = found.file.parent / results.SURVEY
    if not survey.is_file():
        raise InputError(
            f"{folder} cannot be extended: there is no {results.SURVEY} beside the map, which "
            "keeps its scans; maps of other programs, and older ones of `momantu-bt map`, have "
            "none: map the place anew"
        )
    known = stored.read_stored(survey)
    if not known.graph.finished:
        raise InputError(f"{folder} cannot be extended: its scans show no walls to begin at")
    names = found.file.parent / NAMES
    return Earlier(folder, found.grid, known, read_names(names) if names.is_file() else None)


def begun_at(earlier: Earlier, told: Pose2D, rays: Rays) -> Pose2D:
    """`map_from_base` of a robot that is told where it starts, by its first scan.

    Raises:
        Failure: NOT_LOCALIZED, the scan does not fit the map near there.
    """
    hits = rays.origin + rays.directions[rays.hit] * rays.ranges[rays.hit, None]
    share, pose = placed(Side(earlier.grid), hits, told, NEAR)
    if share < FITS:
        raise Failure(
            "NOT_LOCALIZED",
            f"the first scan does not fit the map {earlier.folder} near ({told.x:.2f}, "
            f"{told.y:.2f}), where the robot is told that it starts: {100 * share:.0f} % of it lie "
            f"on walls, {100 * FITS:.0f} % are needed. Was the map made in another frame?",
        )
    return pose


@dataclass(frozen=True, slots=True)
class Joined:
    """Where a log begins on an earlier map. ways: how many ways there are to lay it on the map."""

    start: Pose2D
    ways: int


def joined(
    earlier: Earlier,
    alone: Survey,
    scans: Sequence[LoggedScan],
    progress: Callable[[int, int], bool],
) -> Joined | None:
    """`map_from_base` of a log's first scan: the log's own map laid on the earlier one.

    alone: an empty survey, into which the scans go. None if the progress ended the work.

    Raises:
        InputError: the log shows nothing of the map.
    """
    building.mapped(alone, scans, progress)
    if len(alone.read) < len(scans):
        return None
    survey = alone.finished()
    longest = MatchingConfig().longest
    counts = Occupancy(earlier.grid.resolution, longest, earlier.grid.resolution)
    counts.add(survey.placed())
    found = align(Side(earlier.grid), Side(counts.grid()), SURE_SHARE)
    if found is None:
        raise InputError(
            f"the log shows no place of {earlier.folder} that could be found again, so nothing can "
            "be added; where a log begins does not matter, but they need walls in common"
        )
    return Joined(found.a_from_b @ survey.mapper.poses[0], 1 + len(found.rivals))


def names_on(earlier: Earlier, poses: Sequence[Pose2D]) -> Names | None:
    """The names of an earlier map where they are with its scans, and further ones, at new poses."""
    if earlier.names is None:
        return None
    site = named(Site("earlier").of_a_run(), earlier)
    anchors = Anchors(site)
    anchors.hold_all(earlier.known.graph.poses)
    return anchors.names(poses)


def named(site: Site, earlier: Earlier) -> Site:
    """The site of a run, told the names that were taught on an earlier map."""
    if earlier.names is None:
        return site
    assert isinstance(site.places, Places)
    assert isinstance(site.surfaces, Surfaces)
    for name, pose in earlier.names.places.items():
        site.places.teach(name, Pose2D(*pose))
    for name, surface in earlier.names.surfaces.items():
        site.surfaces.teach(name, surface.surface())
    return site
