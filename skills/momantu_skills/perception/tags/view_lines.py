"""Poses in a file of views: where the hand was, and where the camera saw the target."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from momantu_bt.geometry import Transform

HAND, TARGET = "base_from_hand", "camera_from_target"
"""Keys of both poses; each is x, y, z (m), qx, qy, qz, qw."""


def numbers_of(pose: Transform) -> list[float]:
    """A pose as such a line has it."""
    w, x, y, z = pose.quaternion.tolist()
    return [*pose.position.tolist(), x, y, z, w]


def pose_of(numbers: Any) -> Transform:
    """The pose of a line; ValueError if it is none."""
    x, y, z, qx, qy, qz, qw = (float(value) for value in numbers)
    return Transform((x, y, z), (qw, qx, qy, qz))


def hands_of(file: Path) -> list[Transform]:
    """base_from_hand of all views of a file that have it; none if the file does not exist.

    Raises:
        ValueError: the file cannot be read, or a line is wrong; the message names it.
    """
    if not file.exists():
        return []
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{file} cannot be read: {error}") from None
    found = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            data = json.loads(line)
            if HAND in data:
                found.append(pose_of(data[HAND]))
        except (ValueError, TypeError):
            raise ValueError(f"{file}, line {number}: this is no view of record_view") from None
    return found
