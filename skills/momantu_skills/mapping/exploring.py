"""A building explored in a world: the example tree run, and its map saved whatever happens."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import momantu_bt
from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.site_file import Names
from momantu_bt.world import Site, World
from momantu_skills.mapping import building, results
from momantu_skills.mapping.building import FEWEST
from momantu_skills.mapping.extending import Earlier, named
from momantu_skills.mapping.own import Mapping

with lazily():
    from momantu_skills.mapping.three_d import finishing
    from momantu_skills.mapping.three_d import service as clouds

if TYPE_CHECKING:
    from momantu_skills.mapping.three_d.service import CloudService

TREE = "examples/map_a_building"
SPATIAL = "mapping_3d"
"""Name of the service that maps in three dimensions."""
RESOLUTION = 0.05
"""Cell of the map, m, as the tree saves it."""
LONGEST = 3600.0
"""Simulated time after which the exploration ends, s."""


@dataclass(frozen=True, slots=True)
class Explored:
    """What came of a run. status: as reports have it; why: the failure, "" if there is none.

    about: the report of the saved map; None if there was nothing to save. seconds: simulated time.
    begun: `map_from_base` of the first scan on the earlier map, if there is one.
    """

    status: str
    why: str
    about: dict[str, Any] | None
    seconds: float
    begun: Pose2D | None = None


def explore(
    world: str | World,
    robot: str | None,
    seed: int,
    folder: Path,
    told: Callable[[float, Mapping], None],
    earlier: Earlier | None = None,
    view: int | None = None,
    *,
    spatial: bool = False,
) -> Explored:
    """Run the tree, and save what there is if it does not do so itself.

    Who makes a map puts the robot down and measures where: the map lies in the frame of the site,
    so that the site's names hold on it too.

    folder: is made, or holds the earlier map, which is replaced then. told: hears the clock, s, and
    the service after each tick. earlier: a map to go on with. view: the port of a view in a
    browser. spatial: map in three dimensions too, and save that map.

    Raises:
        OutputError: the folder cannot be written.
        InputError: the robot cannot map in three dimensions.
        MomantuError: the run cannot begin; see `momantu_bt.run`.
    """
    follower = _Follower(told, earlier, spatial=spatial)
    replaces = earlier is not None and folder.resolve() == earlier.folder.resolve()
    report = momantu_bt.run(
        TREE,
        world=world,
        robot=robot,
        measured_start=True,
        seed=seed,
        values={"folder": str(folder), "replace": replaces, "go_on": earlier is not None},
        max_time=LONGEST,
        referee=False,
        watch=follower.watch,
        view_port=view,
    )
    mapping = follower.mapping
    why = "" if report.failure is None else f"{report.failure.code}: {report.failure.message}"
    why = mapping.unplaced or why or report.error or ""
    about = _about(follower, folder, saved=report.status == "SUCCESS")
    begun = None if earlier is None else mapping.begun
    return Explored(report.status, why, about, report.sim_time_s, begun)


def _about(follower: _Follower, folder: Path, *, saved: bool) -> dict[str, Any] | None:
    """The report of the map, which is saved if the tree did not; None: there is too little of it.

    saved: the tree has saved its plan.
    """
    spatially = _save_spatial(follower, folder)
    if spatially is not None:
        return spatially
    if saved:
        return results.read_report(folder)
    if len(follower.mapping.survey.used) >= FEWEST:
        return _save(follower.mapping, folder)
    return None


def _with_clouds(run: Any) -> CloudService:
    """The service that maps in three dimensions, added to a run that has not begun."""
    clouds.check(run.world.robot.description)
    made = clouds.CloudService()
    run.services.add(SPATIAL, made)
    return made


def _save_spatial(follower: _Follower, folder: Path) -> dict[str, Any] | None:
    """Write the map in three dimensions, in the place of the plan; None: none, or too few turns."""
    service, site = follower.clouds, follower.site
    survey = None if service is None else service.survey
    if service is None or survey is None or len(survey.mapper.keyframes) < finishing.FEWEST:
        return None
    stands = follower.mapping.stands
    built = finishing.built_of(survey, RESOLUTION, service.band, service.height, stands)
    names = Names.of(built.poses[0], site.places, site.surfaces)
    results.check_folder(folder, replace=True)
    results.write_folder(
        folder, built.plan, built.stamps, built.poses, built.report, None, names, built.spatial
    )
    return built.report


def _save(mapping: Mapping, folder: Path) -> dict[str, Any]:
    mapping.anchors.note(mapping.survey.mapper.poses)
    built = building.built_of(mapping.survey, RESOLUTION, interrupted=True, stands=mapping.stands)
    names = mapping.anchors.names(built.survey.mapper.poses)
    building.write(folder, built, names)
    return built.report


class _Follower:
    """Watches a run, and prepares it; see `explore` for its arguments."""

    mapping: Mapping
    site: Site

    def __init__(
        self, told: Callable[[float, Mapping], None], earlier: Earlier | None, *, spatial: bool
    ) -> None:
        self._told, self._earlier, self._spatial = told, earlier, spatial
        self.clouds: CloudService | None = None

    def watch(self, run: Any) -> Sequence[Any]:
        """Take hold of the run's mapping before it begins."""
        self.mapping = run.services.running["mapping"]
        self.site = run.context.body.site
        if self._spatial:
            self.clouds = _with_clouds(run)
        if self._earlier is not None:
            self.mapping.earlier = self._earlier
            named(self.site, self._earlier)
        return [self]

    def ticked(self, run: Any) -> None:
        """Tell of the tick."""
        self._told(run.context.now, self.mapping)

    def close(self) -> None:
        """Nothing is open."""
