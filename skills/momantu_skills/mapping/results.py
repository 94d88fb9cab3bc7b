"""The folder of a map: floor plan, picture, trajectory, report."""

from __future__ import annotations

import itertools
import json
import os
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from momantu_bt.formats.files import OutputError, write_whole
from momantu_bt.formats.map_folder import MAP, NAMES, OVERHANG
from momantu_bt.formats.maps import FREE, OCCUPIED, MapPicture, write_map
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.lazy import lazily
from momantu_bt.site_file import Names
from momantu_skills.mapping.mapper import Graph
from momantu_skills.navigation.map.maps import GridMap

with lazily():
    from momantu_skills.mapping.pictures import floor_plan

PICTURE, TRAJECTORY, REPORT = "map.png", "trajectory.tum", "report.json"
SURVEY = "survey.npz"
CLOUD = "cloud.pcd"
FILES = {MAP, "map.pgm", PICTURE, TRAJECTORY, REPORT, NAMES, SURVEY}
SPATIAL_FILES = {CLOUD, OVERHANG, "overhang.pgm"}
"""What a map in three dimensions has beside these."""


def check_folder(folder: Path, *, replace: bool = False) -> None:
    """Check that a map can be written into a folder: it is empty, or there is none yet.

    It is made beside its final name, so what is above it must be writable: this is tried.

    replace: it may also hold a map, and nothing else.

    Raises:
        OutputError: it holds files, or is one, or what is above it is none or cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder} is a file; choose a folder")
    held = {each.name for each in folder.iterdir()} if folder.is_dir() else set[str]()
    if held and not replace:
        raise OutputError(f"{folder} holds files already; choose another folder")
    if not held <= FILES | SPATIAL_FILES:
        other = ", ".join(sorted(held - FILES - SPATIAL_FILES)[:3])
        raise OutputError(f"{folder} holds other files than a map's, such as {other}")
    above = next((each for each in folder.absolute().parents if each.exists()), None)
    try:
        Path(tempfile.mkdtemp(prefix=".probe.", dir=above)).rmdir()
    except OSError as error:
        raise OutputError(
            f"{folder} cannot be written: {above}: {error.strerror or error}; choose a folder "
            "that is yours"
        ) from None


@dataclass(frozen=True, slots=True, eq=False)
class Spatial:
    """What a map in three dimensions has more. cloud: a PCD file. trajectory: `map_from_base`."""

    cloud: bytes
    overhang: MapPicture
    trajectory: Sequence[Transform]


def write_folder(
    folder: Path,
    plan: MapPicture,
    stamps: Sequence[float],
    poses: Sequence[Pose2D],
    report: dict[str, Any],
    survey: bytes | None,
    names: Names | None = None,
    spatial: Spatial | None = None,
) -> None:
    """Write a map, whole or not at all; a map that was there is replaced then.

    survey: what it was made of, as `stored.packed` has it; None: it cannot be extended. names: what
    the robot was taught; by default nothing but where the map begins. spatial: of a map in three
    dimensions, whose poses have its stamps.

    Raises:
        OutputError: the folder cannot be written.
    """
    names = names or Names(start=(poses[0].x, poses[0].y, poses[0].yaw))
    draft = folder.with_name(f".{folder.name}.{os.getpid()}.part")
    try:
        draft.mkdir(parents=True)
        ways = [pose.transform() for pose in poses] if spatial is None else spatial.trajectory
        write_whole(draft / TRAJECTORY, _trajectory(stamps, ways))
        if spatial is not None:
            write_whole(draft / CLOUD, spatial.cloud)
            write_map(draft / OVERHANG, spatial.overhang)
        write_whole(draft / PICTURE, floor_plan.floor_plan_png(GridMap.of(plan), poses, names))
        write_whole(draft / REPORT, json.dumps(report, indent=2) + "\n")
        write_whole(draft / NAMES, names.text())
        if survey is not None:
            write_whole(draft / SURVEY, survey)
        write_map(draft / MAP, plan)
        _take_place(draft, folder)
    except OutputError as error:
        raise OutputError(str(error).replace(str(draft), str(folder))) from None
    except OSError as error:
        raise OutputError(f"{folder} cannot be written: {error.strerror or error}") from None
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def _take_place(draft: Path, folder: Path) -> None:
    """Rename a whole folder; what was there under its name goes afterwards."""
    if not folder.is_dir() or not any(folder.iterdir()):
        draft.rename(folder)
        return
    old = draft.with_suffix(".old")
    folder.rename(old)
    try:
        draft.rename(folder)
    except OSError:
        old.rename(folder)
        raise
    shutil.rmtree(old, ignore_errors=True)


def read_report(folder: Path) -> dict[str, Any] | None:
    """The report of a map; None if the folder holds no whole map."""
    try:
        return dict(json.loads((folder / REPORT).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None


def report_of(plan: MapPicture, graph: Graph) -> dict[str, Any]:
    """What is known of a map, as plain data: m and square metres."""
    steps = zip(itertools.pairwise(graph.poses), graph.motions, strict=True)
    way = sum(a.distance_to(b) for (a, b), motion in steps if motion is not None)
    return {
        "scans": len(graph.poses),
        "sessions": 1 + graph.motions.count(None),
        "way_m": round(way, 3),
        "loops": len(graph.loops),
        **extent_of(plan),
    }


def extent_of(plan: MapPicture) -> dict[str, Any]:
    """The size of a floor plan, as plain data: m and square metres."""
    cells, area = plan.cells(), plan.resolution**2
    return {
        "resolution_m": plan.resolution,
        "size_m": [round(edge * plan.resolution, 3) for edge in cells.shape[::-1]],
        "free_m2": round(float((cells == FREE).sum() * area), 2),
        "occupied_m2": round(float((cells == OCCUPIED).sum() * area), 2),
    }


def _trajectory(stamps: Sequence[float], poses: Sequence[Transform]) -> str:
    """`map_from_base` in the TUM format: stamp x y z qx qy qz qw."""
    lines = ["# map_from_base: stamp x y z qx qy qz qw, s and m"]
    for stamp, pose in zip(stamps, poses, strict=True):
        w, *turn = pose.quaternion
        where = " ".join([f"{value:.6f}" for value in pose.position])
        lines.append(f"{stamp:.6f} {where} {' '.join([f'{value:.9f}' for value in (*turn, w)])}")
    return "\n".join(lines) + "\n"
