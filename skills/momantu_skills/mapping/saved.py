"""A map that was saved: its floor plan, and what else lies beside it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.formats.map_folder import MAP, NAMES, map_file
from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.site_file import Names, read_names
from momantu_skills.mapping import results
from momantu_skills.navigation.map.maps import GridMap, read_grid


@dataclass(frozen=True, eq=False)
class SavedMap:
    """A map of one's own, or one of another program, which has neither way nor report.

    file: its YAML file. way: `map_from_base` of each scan.
    """

    file: Path
    grid: GridMap
    way: tuple[Pose2D, ...]
    names: Names | None
    report: dict[str, Any]

    @cached_property
    def areas(self) -> dict[str, float]:
        """Square metres that are free, occupied and unknown."""
        cell = self.grid.resolution**2
        kinds = (("free", FREE), ("occupied", OCCUPIED), ("unknown", UNKNOWN))
        return {kind: float((self.grid.cells == value).sum() * cell) for kind, value in kinds}


def read_saved(path: Path) -> SavedMap:
    """Read a map: a folder of `momantu-bt map`, or a YAML file of map_server.

    Raises:
        InputError: there is no such map, or the way beside it is broken.
        MapError, SiteFileError: the map or its names are broken.
    """
    file = map_file(path, str(path))
    grid = read_grid(file)
    beside = file.parent if file.name == MAP else None
    if beside is None:
        return SavedMap(file, grid, (), None, {})
    names, way = beside / NAMES, beside / results.TRAJECTORY
    return SavedMap(
        file,
        grid,
        _read_way(way) if way.is_file() else (),
        read_names(names) if names.is_file() else None,
        results.read_report(beside) or {},
    )


def _read_way(path: Path) -> tuple[Pose2D, ...]:
    """The poses of a trajectory in the TUM format."""
    try:
        rows = np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read: {error}") from None
    if rows.size and (rows.shape[1] != 8 or not np.isfinite(rows).all()):
        raise InputError(f"{path}: expected rows of 8 numbers: stamp x y z qx qy qz qw, s and m")
    transforms = (Transform(row[1:4], (row[7], row[4], row[5], row[6])) for row in rows)
    return tuple(map(Pose2D.from_transform, transforms))
