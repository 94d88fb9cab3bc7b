"""Reading floor plans in map_server's format: a YAML file beside a PGM picture, mode trinary."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from momantu_bt.geometry import Array
from momantu_bt.messages import frozen

FREE, OCCUPIED, UNKNOWN = 0, 1, 2

MAX_CELLS = 100_000_000
"""A picture of more pixels is taken for a mistake: 500 m x 500 m at 0.05 m."""


@dataclass(frozen=True, slots=True, eq=False)
class GridMap:
    """A floor plan: `cells[row, column]` is FREE, OCCUPIED or UNKNOWN.

    cells: (rows, columns) uint8, row 0 at the smallest y. resolution: m per cell.
    origin: map coordinates (x, y) of the lower left corner of cell (0, 0), m.
    """

    cells: NDArray[np.uint8]
    resolution: float
    origin: tuple[float, float]

    @property
    def size(self) -> tuple[float, float]:
        """Extent (x, y) in m."""
        rows, columns = self.cells.shape
        return columns * self.resolution, rows * self.resolution

    def index(self, x: float, y: float) -> tuple[int, int]:
        """(row, column) of the cell at map coordinates; may lie outside the grid."""
        return (
            math.floor((y - self.origin[1]) / self.resolution),
            math.floor((x - self.origin[0]) / self.resolution),
        )

    def contains(self, x: float, y: float) -> bool:
        """Whether map coordinates lie on the grid."""
        row, column = self.index(x, y)
        rows, columns = self.cells.shape
        return bool(0 <= row < rows and 0 <= column < columns)

    def centers(self, mask: NDArray[np.bool_]) -> Array:
        """Map coordinates (n, 2) of the centres of the cells where `mask` holds, row by row."""
        rows, columns = np.nonzero(mask)
        middle = np.stack([columns, rows], axis=1) + 0.5
        return np.asarray(middle * self.resolution + np.array(self.origin))


def read_map(path: Path) -> GridMap:
    """The map that a map_server YAML file describes.

    Raises:
        ValueError: a file is missing or broken; the message says which, where and what is valid.
    """
    return _read_map(path.resolve())


@lru_cache(maxsize=8)
def _read_map(path: Path) -> GridMap:
    entry = _read_yaml(path)
    resolution = _number(path, entry, "resolution")
    if not resolution > 0.0:
        raise ValueError(f"{path}: resolution is {resolution}, expected metres per pixel above 0")
    origin = _origin(path, entry)
    if entry.get("mode", "trinary") != "trinary":
        raise ValueError(f"{path}: mode is {entry['mode']!r}, only trinary can be read")
    image = path.parent / str(entry.get("image", ""))
    darkness = 1.0 - _read_pgm(image)
    if entry.get("negate", 0):
        darkness = 1.0 - darkness
    occupied = darkness > _number(path, entry, "occupied_thresh")
    free = darkness < _number(path, entry, "free_thresh")
    cells = np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.uint8)
    return GridMap(frozen(np.ascontiguousarray(cells[::-1])), resolution, origin)


def _read_yaml(path: Path) -> dict[str, Any]:
    try:
        entry = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"the map {path} cannot be read: {error.strerror}") from None
    except (YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is not YAML: {error}") from None
    if not isinstance(entry, dict) or "image" not in entry:
        raise ValueError(
            f"{path} is no map_server file; expected keys image, resolution, origin, negate, "
            "occupied_thresh, free_thresh"
        )
    return entry


def _number(path: Path, entry: dict[str, Any], key: str) -> float:
    value = _finite(entry.get(key))
    if value is None:
        raise ValueError(f"{path}: {key} is {entry.get(key)!r}, expected a number")
    return value


def _origin(path: Path, entry: dict[str, Any]) -> tuple[float, float]:
    origin = entry.get("origin")
    values = [_finite(value) for value in origin] if isinstance(origin, list) else []
    numbers = [value for value in values if value is not None]
    if not len(values) == len(numbers) == 3:
        raise ValueError(f"{path}: origin is {origin!r}, expected [x, y, yaw] in m and rad")
    x, y, yaw = numbers
    if yaw != 0.0:
        raise ValueError(f"{path}: origin has yaw {yaw}; only unturned maps can be read, write 0.0")
    return x, y


def _finite(value: object) -> float | None:
    """A YAML value as a number; None for anything else, infinities and booleans included."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def _read_pgm(path: Path) -> Array:
    """Brightness 0..1 (rows, columns) of a binary or plain PGM picture."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ValueError(f"the map's picture {path} cannot be read: {error.strerror}") from None
    header, start = _pgm_header(path, data)
    magic, columns, rows, brightest = header
    if not 0 < columns * rows <= MAX_CELLS or not 0 < brightest < 65536:
        raise ValueError(f"{path}: {columns} x {rows} pixels up to {brightest} is no sensible map")
    if magic == b"P5":
        kind = np.dtype(np.uint8) if brightest < 256 else np.dtype(">u2")
        body = data[start : start + columns * rows * kind.itemsize]
        pixels = np.frombuffer(body, dtype=kind) if len(body) % kind.itemsize == 0 else None
    else:
        words = data[start:].split()[: columns * rows]
        wrong = next((word for word in words if not word.isdigit()), None)
        if wrong is not None:
            raise ValueError(f"{path}: the pixel {wrong!r} is no whole number")
        pixels = np.array([int(word) for word in words])
    if pixels is None or pixels.size != columns * rows:
        raise ValueError(f"{path} ends early: its header promises {columns} x {rows} pixels")
    return np.asarray(pixels, dtype=np.float64).reshape(rows, columns) / brightest


def _pgm_header(path: Path, data: bytes) -> tuple[tuple[bytes, int, int, int], int]:
    words: list[bytes] = []
    position = 0
    while len(words) < 4 and position < len(data):
        byte = data[position : position + 1]
        if byte == b"#":
            end = data.find(b"\n", position)
            position = len(data) if end < 0 else end
        elif byte.isspace():
            position += 1
        else:
            end = position
            while end < len(data) and not data[end : end + 1].isspace():
                end += 1
            words.append(data[position:end])
            position = end
    numbers = words[1:]
    if len(words) < 4 or words[0] not in (b"P5", b"P2") or not all(w.isdigit() for w in numbers):
        raise ValueError(f"{path} is no PGM picture; expected a header such as 'P5 400 300 255'")
    return (words[0], int(words[1]), int(words[2]), int(words[3])), position + 1
