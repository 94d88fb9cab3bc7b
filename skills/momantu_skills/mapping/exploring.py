"""A building explored in a world: the example tree run, and its map saved whatever happens."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import momantu_bt
from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names
from momantu_bt.world import World
from momantu_skills.mapping import building, results
from momantu_skills.mapping.building import FEWEST
from momantu_skills.mapping.own import Mapping

TREE = "examples/map_a_building"
RESOLUTION = 0.05
"""Cell of the map, m, as the tree saves it."""
LONGEST = 3600.0
"""Simulated time after which the exploration ends, s."""


@dataclass(frozen=True, slots=True)
class Explored:
    """What came of a run. status: as reports have it; why: the failure, "" if there is none.

    about: the report of the saved map; None if there was nothing to save. seconds: simulated time.
    """

    status: str
    why: str
    about: dict[str, Any] | None
    seconds: float


def explore(
    world: str | World,
    robot: str | None,
    seed: int,
    folder: Path,
    told: Callable[[float, Mapping], None],
) -> Explored:
    """Run the tree, and save what there is if it does not do so itself.

    Who makes a map puts the robot down and measures where: the map lies in the frame of the site,
    so that the site's names hold on it too.

    told: hears the clock, s, and the service after each tick.

    Raises:
        OutputError: the folder cannot be written.
        MomantuError: the run cannot begin; see `momantu_bt.run`.
    """
    follower = _Follower(told)

    def watch(run: Any) -> Sequence[Any]:
        follower.mapping = run.services.running["mapping"]
        follower.site = run.context.body.site
        return [follower]

    report = momantu_bt.run(
        TREE,
        world=world,
        robot=robot,
        measured_start=True,
        seed=seed,
        values={"folder": str(folder)},
        max_time=LONGEST,
        referee=False,
        watch=watch,
    )
    why = "" if report.failure is None else f"{report.failure.code}: {report.failure.message}"
    about = results.read_report(folder)
    if about is None and len(follower.mapping.survey.used) >= FEWEST:
        about = _save(follower, folder)
    return Explored(report.status, why or (report.error or ""), about, report.sim_time_s)


def _save(follower: _Follower, folder: Path) -> dict[str, Any]:
    mapping, site = follower.mapping, follower.site
    built = building.built_of(mapping.survey, RESOLUTION, interrupted=True, stands=mapping.stands)
    start: Pose2D = built.poses[0]
    names = Names.of(start, site.places, site.surfaces)
    results.write_folder(folder, built.plan, built.stamps, built.poses, built.report, names)
    return built.report


class _Follower:
    """Watches a run."""

    def __init__(self, told: Callable[[float, Mapping], None]) -> None:
        self._told = told
        self.mapping: Mapping
        self.site: Any

    def ticked(self, run: Any) -> None:
        """Tell of the tick."""
        self._told(run.context.now, self.mapping)

    def close(self) -> None:
        """Nothing is open."""
