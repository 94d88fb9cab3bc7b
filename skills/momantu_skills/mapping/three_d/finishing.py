"""From a survey in three dimensions to what the folder of a map holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Pose2D, Transform, path_lengths
from momantu_skills.mapping.occupancy import floor_plan
from momantu_skills.mapping.results import Spatial, extent_of
from momantu_skills.mapping.three_d.pcd import pcd
from momantu_skills.mapping.three_d.raster import cloud_of, overhang_of, scans_of
from momantu_skills.mapping.three_d.surveying import CloudSurvey

FEWEST = 2
"""Fewest kept turns of a map."""


@dataclass(frozen=True, slots=True, eq=False)
class BuiltCloud:
    """A map in three dimensions. poses: `map_from_base` of the turns at `stamps`, on the floor."""

    plan: MapPicture
    stamps: tuple[float, ...]
    poses: tuple[Pose2D, ...]
    report: dict[str, Any]
    spatial: Spatial


def built_of(
    survey: CloudSurvey,
    resolution: float,
    band: tuple[float, float],
    height: float,
    stands: float = 0.0,
) -> BuiltCloud:
    """The map of a survey.

    resolution: of the floor plan, m. band: lowest and highest point that the plan has, m; height:
    of the robot, which sets what overhangs the floor, m. stands: radius of the base, m.
    """
    mapper = survey.mapper
    mapper.finish()
    cloud = cloud_of(mapper)
    plan = floor_plan(
        scans_of(mapper, survey.base_from_lidar, band), resolution, mapper.config.farthest, stands
    )
    stamps, places = zip(*mapper.trajectory(), strict=True)
    kept = [Pose2D.from_transform(pose) for pose in mapper.poses]
    spatial = Spatial(pcd(cloud), overhang_of(cloud, plan, band, height), places)
    report = {
        "dimensions": 3,
        "turns_read": len(places),
        "turns_doubtful": mapper.doubtful,
        "points": len(cloud),
        "scans": len(kept),
        "way_m": round(path_lengths(kept)[-1], 3),
        "loops": len(mapper.closed),
        **extent_of(plan),
    }
    return BuiltCloud(plan, stamps, _on_floor(places), report, spatial)


def _on_floor(places: tuple[Transform, ...]) -> tuple[Pose2D, ...]:
    return tuple(Pose2D.from_transform(place) for place in places)
