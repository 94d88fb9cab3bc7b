"""The folder of a map: floor plan, picture, trajectory, report."""

from __future__ import annotations

import io
import itertools
import json
import os
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.files import OutputError, write_whole
from momantu_bt.formats.maps import FREE, OCCUPIED, MapPicture, write_map
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.lazy import lazily
from momantu_bt.site_file import Names

with lazily():
    from PIL import Image, ImageDraw

MAP, PICTURE, TRAJECTORY, REPORT = "map.yaml", "map.png", "trajectory.tum", "report.json"
NAMES = "site.yaml"
CLOUD, OVERHANG = "cloud.pcd", "overhang.yaml"
FILES = {MAP, "map.pgm", PICTURE, TRAJECTORY, REPORT, NAMES}
SPATIAL_FILES = {CLOUD, OVERHANG, "overhang.pgm"}
"""What a map in three dimensions has beside these."""
_WAY = (200, 60, 40)
_START, _END = (40, 140, 60), (40, 80, 200)
_LEAST_EDGE = 800
"""Pixels of the picture's longer side; small maps are drawn larger."""


def check_folder(folder: Path, *, replace: bool = False) -> None:
    """Check that a map can be written into a folder: it is empty, or there is none yet.

    replace: it may also hold a map, and nothing else.

    Raises:
        OutputError: it holds files, or is one.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder} is a file; choose a folder")
    held = {each.name for each in folder.iterdir()} if folder.is_dir() else set[str]()
    if held and not replace:
        raise OutputError(f"{folder} holds files already; choose another folder")
    if not held <= FILES | SPATIAL_FILES:
        other = ", ".join(sorted(held - FILES - SPATIAL_FILES)[:3])
        raise OutputError(f"{folder} holds other files than a map's, such as {other}")


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
    names: Names | None = None,
    spatial: Spatial | None = None,
) -> None:
    """Write a map, whole or not at all; a map that was there is replaced then.

    names: what the robot was taught; by default nothing but where the map begins. spatial: of a map
    in three dimensions, whose poses have its stamps.

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
        write_whole(draft / PICTURE, _picture(plan, poses))
        write_whole(draft / REPORT, json.dumps(report, indent=2) + "\n")
        write_whole(draft / NAMES, names.text())
        write_map(draft / MAP, plan)
        _take_place(draft, folder)
    except OutputError:
        raise
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


def report_of(plan: MapPicture, poses: Sequence[Pose2D], loops: int) -> dict[str, Any]:
    """What is known of a map, as plain data: m and square metres."""
    cells, area = plan.cells(), plan.resolution**2
    way = sum(a.distance_to(b) for a, b in itertools.pairwise(poses))
    return {
        "scans": len(poses),
        "way_m": round(way, 3),
        "loops": loops,
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


def _picture(plan: MapPicture, poses: Sequence[Pose2D]) -> bytes:
    """A PNG of the floor plan with the way driven, green at its start and blue at its end."""
    levels: NDArray[np.uint8] = plan.levels.astype(np.uint8)
    scale = max(1, round(_LEAST_EDGE / max(levels.shape)))
    image = Image.fromarray(levels).convert("RGB")
    image = image.resize((image.width * scale, image.height * scale), Image.Resampling.NEAREST)
    draw = ImageDraw.Draw(image)
    per_metre = scale / plan.resolution
    places = [
        (
            (pose.x - plan.origin[0]) * per_metre,
            image.height - (pose.y - plan.origin[1]) * per_metre,
        )
        for pose in poses
    ]
    draw.line(places, fill=_WAY, width=max(1, scale // 2))
    for (x, y), colour in ((places[0], _START), (places[-1], _END)):
        r = 2.0 * scale
        draw.ellipse((x - r, y - r, x + r, y + r), fill=colour)
    stream = io.BytesIO()
    image.save(stream, "PNG")
    return stream.getvalue()
