"""Write a camera's picture size and field of view into a robot file; all else stays as it is."""

from __future__ import annotations

import math
import re
from pathlib import Path

from momantu_bt.errors import InputError
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.formats.names import valid_names
from momantu_bt.robots.reader import read_robot_file
from momantu_bt.robots.robot_file import RobotFile
from momantu_skills.calibration.camera.lens import Lens
from momantu_skills.calibration.robot_write import file_of

_KIND = "camera"
_PLACES = 7
"""Decimals of the angle, rad."""


def chosen(path: Path, sensor: str | None) -> str:
    """The camera of a robot file that takes the lens: the named one, or its only one.

    Raises:
        InputError: it is no robot file, has no such camera, or cannot be written.
    """
    file = file_of(path)
    if not file.is_file():
        raise InputError(f"there is no robot file {file}; `momantu-bt robots setup` makes one")
    check_writable(file)
    cameras = _cameras(read_robot_file(file))
    if sensor is None and len(cameras) == 1:
        return cameras[0]
    if sensor is None:
        raise InputError(f"{file} has {len(cameras)} cameras; --sensor names one: {cameras}")
    if sensor not in cameras:
        known = valid_names(sensor, cameras, "cameras")
        raise InputError(f"{file} has no camera {sensor!r}; {known}")
    return sensor


def write(path: Path, sensor: str, lens: Lens, size: tuple[int, int]) -> str:
    """Write the lens, of rectified pictures, and say what changed.

    Raises:
        InputError: the sensor is not written as a block with a key in each line.
    """
    file = file_of(path)
    text = file.read_text(encoding="utf-8")
    before = read_robot_file(file).sensors[sensor]
    angle = 2.0 * math.atan(0.5 * size[0] / float(lens.matrix[0, 0]))
    values = {
        "width": f"{size[0]}",
        "height": f"{size[1]}",
        "horizontal_fov": f"{angle:.{_PLACES}f}",
    }
    block = re.search(
        rf"^sensors:.*\n(?:(?:[ #].*)?\n)*?(?P<name> +){re.escape(sensor)}:[ ]*(?:#.*)?\n"
        rf"(?P<body>(?:(?P=name) +.*\n|[ ]*(?:#.*)?\n)+)",
        text,
        re.MULTILINE,
    )
    if block is None:
        raise InputError(
            f"{file}: the sensor {sensor} is not written with a key in each line; write width, "
            f"height and horizontal_fov yourself: {', '.join(map(': '.join, values.items()))}"
        )
    body = block["body"]
    for key, value in values.items():
        body, found = re.subn(rf"(?m)^( +{key}: *)\S.*$", rf"\g<1>{value}", body, count=1)
        if not found:
            indent = re.match(r" *", body.lstrip("\n")) or [""]
            body = f"{indent[0]}{key}: {value}\n{body}"
    write_whole(file, text[: block.start("body")] + body + text[block.end("body") :])
    old = getattr(before, "horizontal_fov", angle)
    return f"{sensor}: field of view {math.degrees(old):.2f} -> {math.degrees(angle):.2f} deg"


def _cameras(robot: RobotFile) -> list[str]:
    return [name for name, sensor in robot.sensors.items() if sensor.kind == _KIND]
