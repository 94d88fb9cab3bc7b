"""Files of views: what the robot measured at each view of tags, a JSON object per line."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.formats.text import TextError, read_text
from momantu_bt.geometry import Array
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.perception.tags.view_lines import HAND, TARGET

_MOST_BYTES = 200_000_000
_KEYS = ("stamp", "camera", "intrinsics", "joints", "odometry", "tags", HAND, TARGET)
_LARGE_EDGE = 2.0
"""m; a tag with a larger edge was written in other units."""


@dataclass(frozen=True, slots=True, eq=False)
class TagSeen:
    """One tag in a picture.

    edge: m. corners: (4, 2) px: lower left, lower right, upper right, upper left as printed.
    """

    tag_id: int
    edge: float
    corners: Array


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One line. joints: rad or m by name; odometry: x, y, yaw in m and rad, or None.

    intrinsics: fx, fy, cx, cy in px, of an undistorted picture; None in a line without tags.
    camera: None, the robot's first one. hand, target: base_from_hand and camera_from_target, each
    x, y, z in m, qx, qy, qz, qw.
    """

    line: int
    stamp: float
    camera: str | None
    intrinsics: Array | None
    joints: dict[str, float]
    odometry: Array | None
    tags: tuple[TagSeen, ...]
    hand: Array | None = None
    target: Array | None = None


def read_rows(path: Path) -> list[Row]:
    """The lines of a file of views; stamps ascend.

    Raises:
        CalibrationError: the file cannot be read, or a line is wrong; the message names it.
    """
    try:
        text = read_text(path, str(path), "file of views", _MOST_BYTES)
    except TextError as error:
        raise CalibrationError(f"{path}: {error.problem.message}") from None
    except OSError as error:
        raise CalibrationError(f"{path} cannot be read: {error.strerror or error}") from None
    rows = list(_rows(path, text))
    if not rows:
        raise CalibrationError(
            f"{path} has no views; a view is one line of JSON, such as {EXAMPLE}"
        )
    return rows


EXAMPLE = (
    '{"stamp": 1.0, "intrinsics": [554, 554, 320, 240], "joints": {"elbow": 0.4}, '
    '"odometry": [0, 0, 0], "tags": [{"id": 3, "edge": 0.06, '
    '"corners": [[310, 250], [330, 250], [330, 230], [310, 230]]}]}'
)


def _rows(path: Path, text: str) -> Iterator[Row]:
    before = -math.inf
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            row = _row(number, json.loads(line))
        except json.JSONDecodeError as error:
            raise CalibrationError(
                f"{path}, line {number}, column {error.colno}: this is no JSON: {error.msg}; "
                f"expected one object per line, such as {EXAMPLE}"
            ) from None
        except _WrongError as error:
            raise CalibrationError(f"{path}, line {number}: {error}") from None
        if row.stamp < before:
            raise CalibrationError(
                f"{path}, line {number}: the stamp {row.stamp:g} is before that of the line above, "
                f"{before:g}; write the lines in the order in which they were measured"
            )
        before = row.stamp
        yield row


class _WrongError(Exception):
    """What is wrong in a line."""


def _row(number: int, data: Any) -> Row:
    if not isinstance(data, dict):
        raise _WrongError(f"expected an object with the keys {', '.join(_KEYS)}")
    unknown = [key for key in data if key not in _KEYS]
    if unknown:
        raise _WrongError(f"there is no key {unknown[0]!r}; keys: {', '.join(_KEYS)}")
    camera = data.get("camera")
    if camera is not None and not isinstance(camera, str):
        raise _WrongError(f"camera: expected a name, not {camera!r}")
    joints = data.get("joints", {})
    if not isinstance(joints, dict):
        raise _WrongError("joints: expected positions by name")
    given = data.get("tags", [])
    if not isinstance(given, list):
        raise _WrongError("tags: expected a list")
    tags = tuple(_tag(each) for each in given)
    ids = [tag.tag_id for tag in tags]
    if len(set(ids)) < len(ids):
        raise _WrongError(f"a tag is twice in one picture: {sorted(ids)}")
    lens = _numbers(data, "intrinsics", 4, "[fx, fy, cx, cy] in pixels") if tags else None
    if lens is not None and lens[:2].min() <= 0:
        raise _WrongError("intrinsics: fx and fy are above 0, in pixels")
    odometry = data.get("odometry")
    return Row(
        number,
        _number(data.get("stamp"), "stamp", "seconds"),
        camera,
        lens,
        {str(name): _number(at, f"joint {name}", "rad or m") for name, at in joints.items()},
        None if odometry is None else _numbers(data, "odometry", 3, "[x, y, yaw] in m and rad"),
        tags,
        _pose(data, HAND),
        _pose(data, TARGET),
    )


def _pose(data: dict[str, Any], key: str) -> Array | None:
    return _numbers(data, key, 7, "[x, y, z, qx, qy, qz, qw]") if key in data else None


def _tag(data: Any) -> TagSeen:
    if not isinstance(data, dict) or set(data) != {"id", "edge", "corners"}:
        raise _WrongError("a tag has exactly the keys id, edge and corners")
    tag_id = data["id"]
    if not isinstance(tag_id, int) or isinstance(tag_id, bool) or tag_id < 0:
        raise _WrongError(f"a tag's id is a whole number from 0, not {tag_id!r}")
    edge = _number(data["edge"], f"edge of tag {tag_id}", "m")
    if not 0.0 < edge <= _LARGE_EDGE:
        raise _WrongError(
            f"the edge of tag {tag_id} is {edge:g} m; expected more than 0 and at most "
            f"{_LARGE_EDGE:g} m (the black square's side, in metres)"
        )
    corners = data["corners"]
    if not isinstance(corners, list) or len(corners) != 4:
        raise _WrongError(f"tag {tag_id}: expected four corners [u, v] in pixels")
    return TagSeen(tag_id, edge, np.array([_corner(each, tag_id) for each in corners]))


def _corner(data: Any, tag_id: int) -> Array:
    return _numbers({"corner": data}, "corner", 2, f"[u, v] of tag {tag_id} in pixels")


def _numbers(data: dict[str, Any], key: str, count: int, what: str) -> Array:
    given = data.get(key)
    if not isinstance(given, list) or len(given) != count:
        raise _WrongError(f"{key}: expected {what}, not {json.dumps(given)}")
    return np.array([_number(each, key, what) for each in given])


def _number(value: Any, name: str, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise _WrongError(f"{name}: expected a finite number ({what}), not {json.dumps(value)}")
    return float(value)
