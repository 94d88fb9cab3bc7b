"""Floor plans in map_server's format: a YAML file beside a PGM or PNG picture.

A plan in another mode than trinary, or turned, is read as the trinary and unturned one of the same
building. Pillow reads the picture: PGM (P2 and P5, any number of grey levels, comments), PNG and
BMP, as map_server does; https://docs.ros.org/en/jazzy/p/nav2_map_server says what the keys mean.
"""

from __future__ import annotations

import itertools
import math
import re
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import UnidentifiedImageError

from momantu_bt.errors import MomantuError
from momantu_bt.formats.files import write_whole
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import excerpt
from momantu_bt.formats.yaml.errors import YamlRules
from momantu_bt.formats.yaml.reader import YamlSyntaxError, compose
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.lazy import lazily

with lazily():
    from PIL import Image

FREE, OCCUPIED, UNKNOWN = 0, 1, 2
"""The values of a cell."""
OCCUPIED_ABOVE, FREE_BELOW = 0.65, 0.196
"""map_server's default thresholds of darkness (0 white, 1 black) of occupied and free cells."""
MODES = ("trinary", "scale", "raw")
"""What the levels of a picture mean: free, occupied or neither; how likely occupied; occupancy in
percent."""
RAW_MOST = 100
"""Occupancy of an occupied cell in mode raw; higher levels are unknown."""
CELL_LEVELS = np.array([254, 0, 205], dtype=np.uint8)
"""The grey levels with which map_saver writes FREE, OCCUPIED and UNKNOWN."""
PARTS = (0.25, 0.75)
"""Where a cell of a turned plan is looked up, as shares of its edge: no thin wall falls between."""
MAX_CELLS = 100_000_000
"""Most pixels of a picture, enough for 500 m x 500 m at 0.05 m; more are taken for a mistake."""

_RULES = YamlRules("map file", most_bytes=100_000, most_depth=10, most_values=1000)
_FORMATS = ("PPM", "PNG", "BMP")
"""Pillow's names of the formats; PPM includes PGM."""
_GAP = rb"(?:\s|#[^\r\n]*[\r\n])+"
_PGM = re.compile(rb"P[25]" + _GAP + rb"\d+" + _GAP + rb"\d+" + _GAP + rb"(\d+)\s")


class MapError(MomantuError, ValueError):
    """A map is missing or broken; the message says which file, where and what is valid."""


@dataclass(frozen=True, slots=True, eq=False)
class MapPicture:
    """The content of a map's files.

    levels: grey levels (rows, columns), row 0 at the top, 0 black. brightest: the level of white.
    resolution: m per pixel. origin: map coordinates (x, y) of the picture's lower left corner, m.
    negate: white is occupied. occupied_thresh, free_thresh: shares of black, as in the YAML file.
    """

    levels: NDArray[Any]
    resolution: float
    origin: tuple[float, float]
    brightest: int = 255
    negate: bool = False
    occupied_thresh: float = OCCUPIED_ABOVE
    free_thresh: float = FREE_BELOW

    @property
    def free_level(self) -> int:
        """The grey level of a cell that is surely free."""
        return 0 if self.negate else self.brightest

    def occupied(self) -> NDArray[np.bool_]:
        """Which pixels are occupied: (rows, columns) of bool, row 0 at the top."""
        return np.asarray(self._darkness() > self.occupied_thresh)

    def cells(self) -> NDArray[np.uint8]:
        """The cells: (rows, columns) of FREE, OCCUPIED and UNKNOWN, row 0 at the smallest y."""
        free = self._darkness() < self.free_thresh
        cells = np.where(self.occupied(), OCCUPIED, np.where(free, FREE, UNKNOWN))
        return np.ascontiguousarray(cells.astype(np.uint8)[::-1])

    def _darkness(self) -> NDArray[np.float64]:
        darkness = 1.0 - np.asarray(self.levels, dtype=np.float64) / self.brightest
        return 1.0 - darkness if self.negate else darkness


def picture_file(path: Path) -> Path:
    """The picture that a map's YAML file names; raises MapError if that file is broken."""
    return path.parent / str(_read_yaml(path)["image"])


def read_map(path: Path) -> MapPicture:
    """The map that a map_server YAML file describes.

    Raises:
        MapError: a file is missing or broken.
    """
    entry = _read_yaml(path)
    resolution = _number(path, entry, "resolution")
    if not resolution > 0.0:
        raise MapError(f"{path}: resolution is {resolution}, expected metres per pixel above 0")
    x, y, yaw = _origin(path, entry)
    mode = entry.get("mode", "trinary")
    if mode not in MODES:
        raise MapError(f"{path}: mode is {mode!r}; {valid_names(str(mode), MODES, 'modes')}")
    high, low = _thresholds(path, entry)
    file = path.parent / str(entry["image"])
    levels, brightest = _read_picture(file)
    picture = MapPicture(levels, resolution, (x, y), brightest, _negate(path, entry), high, low)
    if mode != "trinary":
        picture = _of_cells(_raw(picture) if mode == "raw" else _scaled(picture, file), picture)
    return picture if yaw == 0.0 else _unturned(picture, yaw)


def _of_cells(cells: NDArray[np.uint8], of: MapPicture) -> MapPicture:
    """A trinary picture of cells (rows, columns), row 0 at the smallest y, where `of` lies."""
    return MapPicture(CELL_LEVELS[cells[::-1]], of.resolution, of.origin)


def _scaled(picture: MapPicture, file: Path) -> NDArray[np.uint8]:
    """Cells of mode scale: between the thresholds what is likelier, unknown where transparent."""
    middle = 0.5 * (picture.occupied_thresh + picture.free_thresh)
    cells = replace(picture, occupied_thresh=middle, free_thresh=middle).cells()
    with Image.open(file, formats=_FORMATS) as image:
        if image.mode in ("LA", "RGBA", "PA"):
            seen = np.asarray(image.getchannel("A"))[::-1] == np.uint8(255)
            cells[~seen] = UNKNOWN
    return cells


def _raw(picture: MapPicture) -> NDArray[np.uint8]:
    """Cells of mode raw, whose levels are percentages; `negate` does not count there."""
    percent = np.asarray(picture.levels, dtype=np.float64)[::-1]
    occupied = percent > picture.occupied_thresh * RAW_MOST
    free = percent < picture.free_thresh * RAW_MOST
    cells = np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN))
    return np.where(percent > RAW_MOST, UNKNOWN, cells).astype(np.uint8)


def _unturned(picture: MapPicture, yaw: float) -> MapPicture:
    """The same plan on cells along the map's axes; yaw: of the picture about its lower left, rad.

    A cell is occupied if any part of it is; otherwise it is what is in its middle.
    """
    cells, cell = picture.cells(), picture.resolution
    rows, columns = cells.shape
    c, s = math.cos(yaw), math.sin(yaw)
    corners = np.array([[0, 0], [columns, 0], [0, rows], [columns, rows]]) * cell
    corners = corners @ np.array([[c, s], [-s, c]]) + picture.origin
    low = corners.min(axis=0)
    wide, high = np.ceil((corners.max(axis=0) - low) / cell - 1e-6).astype(int)

    def looked_up(along: float, up: float) -> NDArray[np.uint8]:
        x = low[0] - picture.origin[0] + (np.arange(wide) + along)[None, :] * cell
        y = low[1] - picture.origin[1] + (np.arange(high) + up)[:, None] * cell
        column = np.floor((c * x + s * y) / cell).astype(np.int64)
        row = np.floor((c * y - s * x) / cell).astype(np.int64)
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        found = np.full(column.shape, UNKNOWN, dtype=np.uint8)
        found[inside] = cells[row[inside], column[inside]]
        return found

    turned = looked_up(0.5, 0.5)
    for along, up in itertools.product(PARTS, PARTS):
        turned[looked_up(along, up) == OCCUPIED] = OCCUPIED
    at = (float(low[0]), float(low[1]))
    return _of_cells(turned, replace(picture, origin=at))


def write_map(path: Path, map_: MapPicture) -> None:
    """Write a map as YAML beside a binary PGM of the same name.

    Raises:
        OutputError: the folder cannot be written.
    """
    picture = path.with_suffix(".pgm")
    rows, columns = map_.levels.shape
    kind = np.dtype(np.uint8) if map_.brightest < 256 else np.dtype(">u2")
    header = f"P5\n{columns} {rows}\n{map_.brightest}\n"
    write_whole(picture, header.encode() + map_.levels.astype(kind).tobytes())
    text = (
        f"image: {picture.name}\n"
        f"resolution: {map_.resolution!r}\n"
        f"origin: [{map_.origin[0]!r}, {map_.origin[1]!r}, 0]\n"
        f"negate: {int(map_.negate)}\n"
        f"occupied_thresh: {map_.occupied_thresh!r}\n"
        f"free_thresh: {map_.free_thresh!r}\n"
    )
    write_whole(path, text)


def _read_yaml(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        entry = plain_value(compose(text, str(path), _RULES))
    except OSError as error:
        raise MapError(f"the map {path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise MapError(f"{path} is not UTF-8 text: {error}") from None
    except YamlSyntaxError as error:
        raise MapError(
            f"{error}\n{excerpt(error.problem.place, text, error.problem.hint)}"
        ) from None
    if not isinstance(entry, dict) or "image" not in entry:
        raise MapError(
            f"{path} is not a map_server file; expected keys image, resolution, origin, negate, "
            "occupied_thresh, free_thresh"
        )
    return entry


def _number(path: Path, entry: dict[str, Any], key: str) -> float:
    value = _finite(entry.get(key))
    if value is None:
        raise _wrong(path, entry, key, "a number")
    return value


def _thresholds(path: Path, entry: dict[str, Any]) -> tuple[float, float]:
    """`occupied_thresh` and `free_thresh`."""
    high, low = _number(path, entry, "occupied_thresh"), _number(path, entry, "free_thresh")
    if not 0.0 <= low <= high <= 1.0:
        raise MapError(
            f"{path}: free_thresh is {low} and occupied_thresh {high}; expected shares of black "
            "from 0 to 1, the first no larger than the second"
        )
    return high, low


def _negate(path: Path, entry: dict[str, Any]) -> bool:
    value = entry.get("negate", 0)
    if isinstance(value, bool) or (isinstance(value, int) and value in (0, 1)):
        return bool(value)
    raise MapError(f"{path}: negate is {value!r}; expected 0, or 1 where white is occupied")


def _origin(path: Path, entry: dict[str, Any]) -> tuple[float, float, float]:
    origin = entry.get("origin")
    values = [_finite(value) for value in origin] if isinstance(origin, list) else []
    numbers = [value for value in values if value is not None]
    if not len(values) == len(numbers) == 3:
        raise _wrong(path, entry, "origin", "[x, y, yaw] in m and rad")
    x, y, yaw = numbers
    return x, y, yaw


def _wrong(path: Path, entry: dict[str, Any], key: str, expected: str) -> MapError:
    said = f"{path}: {key} is {entry[key]!r}" if key in entry else f"{path} has no {key}"
    return MapError(f"{said}, expected {expected}")


def _finite(value: object) -> float | None:
    """A YAML value as a number; None for anything else, infinities and booleans included."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def _read_picture(path: Path) -> tuple[NDArray[Any], int]:
    """Grey levels (rows, columns) of a picture, and the level of white."""
    try:
        with warnings.catch_warnings(action="ignore"), Image.open(path, formats=_FORMATS) as image:
            columns, rows = image.size
            if columns * rows > MAX_CELLS:
                raise MapError(f"{path}: {columns} x {rows} pixels; at most {MAX_CELLS} are read")
            fine = image.mode in ("I", "I;16")
            levels = np.asarray(image if fine else image.convert("L"))
    except MapError:
        raise
    except FileNotFoundError:
        raise MapError(f"the map's picture {path} cannot be read: there is no such file") from None
    except UnidentifiedImageError:
        raise MapError(
            f"the map's picture {path} cannot be read: it is neither a PGM, a PNG nor a BMP file"
        ) from None
    except (OSError, ValueError, SyntaxError, OverflowError, Image.DecompressionBombError) as error:
        raise MapError(f"the map's picture {path} cannot be read: {error}") from None
    white = 255 if levels.dtype == np.uint8 else 65535
    brightest = _brightest(path) or white
    if brightest != white:  # Pillow scales levels up to white; undo that
        levels = np.rint(levels * (brightest / white)).astype(np.int32)
    return levels, brightest


def _brightest(path: Path) -> int | None:
    """The level of white that a PGM file names in its header."""
    with path.open("rb") as file:
        found = _PGM.match(file.read(4096))
    return None if found is None else int(found[1])
