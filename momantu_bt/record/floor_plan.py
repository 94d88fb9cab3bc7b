"""The site's floor plan as a grid: `/map`, once."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from momantu_bt.frames import MAP
from momantu_bt.geometry import Transform
from momantu_bt.record.channel import time_text
from momantu_bt.record.poses import pose_text

FREE, OCCUPIED, UNKNOWN = 0, 100, 255
"""What a cell's byte says."""
_UINT8 = 1
"""foxglove.NumericType."""
_GAP = rb"(?:\s|#[^\n]*\n)+"
_PGM = re.compile(rb"P5" + _GAP + rb"(\d+)" + _GAP + rb"(\d+)" + _GAP + rb"(\d+)\s")


@dataclass(frozen=True, slots=True, eq=False)
class FloorPlan:
    """cells: (rows, columns) uint8, row 0 at the smallest y. resolution: m per cell.

    origin: (x, y) of the corner of cell (0, 0) in the map, m.
    """

    cells: NDArray[np.uint8]
    resolution: float
    origin: tuple[float, float]


def read_floor_plan(file: Path) -> FloorPlan:
    """Read map_server's YAML and its binary PGM, mode trinary.

    Raises:
        ValueError: one of them is missing or is not what it should be.
    """
    try:
        entry = YAML(typ="safe", pure=True).load(file.read_text(encoding="utf-8"))
        resolution = float(entry["resolution"])
        x, y = (float(part) for part in entry["origin"][:2])
        darkness = 1.0 - _read_pgm(file.parent / str(entry["image"]))
        if entry.get("negate", 0):
            darkness = 1.0 - darkness
        occupied = darkness > float(entry["occupied_thresh"])
        free = darkness < float(entry["free_thresh"])
    except (OSError, YAMLError, KeyError, TypeError, AttributeError, ValueError) as error:
        raise ValueError(f"{file} is no floor plan: {error!r}") from None
    cells = np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.uint8)
    return FloorPlan(np.ascontiguousarray(cells[::-1]), resolution, (x, y))


def _read_pgm(path: Path) -> NDArray[np.float64]:
    """Brightness (rows, columns) in 0..1, row 0 at the top."""
    data = path.read_bytes()
    header = _PGM.match(data)
    if header is None:
        raise ValueError(f"{path} is no binary PGM picture")
    columns, rows, most = (int(number) for number in header.groups())
    pixels = np.frombuffer(data, dtype=np.uint8, offset=header.end())
    if not 0 < most < 256 or len(pixels) < columns * rows:
        raise ValueError(f"{path} has not the {columns} x {rows} bytes that it promises")
    return pixels[: columns * rows].reshape(rows, columns) / most


def grid_text(plan: FloorPlan) -> str:
    """The plan as a message for viewers."""
    corner = pose_text(Transform((*plan.origin, 0.0)))
    columns, size = plan.cells.shape[1], plan.resolution
    data = base64.b64encode(plan.cells.tobytes()).decode("ascii")
    return (
        f'{{"timestamp":{time_text(0.0)},"frame_id":"{MAP}","pose":{corner},'
        f'"column_count":{columns},"cell_size":{{"x":{size!r},"y":{size!r}}},'
        f'"row_stride":{columns},"cell_stride":1,'
        f'"fields":[{{"name":"occupancy","offset":0,"type":{_UINT8}}}],"data":"{data}"}}'
    )
