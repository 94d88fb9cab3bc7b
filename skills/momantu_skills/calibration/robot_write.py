"""Write a robot's calibration into its robot file, on top of one that is there."""

from __future__ import annotations

import re
from pathlib import Path

from momantu_bt.errors import InputError
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.geometry import Transform
from momantu_bt.robot import RobotDescription, WheelCorrection
from momantu_bt.robots.reader import FILE, read_robot_file
from momantu_bt.robots.robot_file import Calibration, CameraCorrection
from momantu_bt.wheels import Wheels
from momantu_skills.calibration.robot.estimate import Calibrated
from momantu_skills.calibration.robot.parameters import mounted
from momantu_skills.calibration.robot_text import zeros

_SECTION = re.compile(r"^calibration:.*\n(?:(?:[ \t#].*)?\n)*", re.MULTILINE)
_HEAD = "# What `momantu-bt calibrate robot` found: rad, m, and factors minus one.\n"


def refuse_wrong(path: Path, description: RobotDescription) -> None:
    """Refuse a file that cannot take the calibration.

    Raises:
        InputError: it is no robot file, or another robot's, or cannot be written.
    """
    file = file_of(path)
    if not file.is_file():
        source = description.source
        copy = "" if source is None else f"; make a copy first: cp -r {source.parent} {file.parent}"
        raise InputError(f"there is no robot file {file}{copy}")
    check_writable(file)
    name = read_robot_file(file).name
    if name != description.name:
        raise InputError(f"{file} describes {name}, and the views are of {description.name}")


def write(path: Path, found: Calibrated) -> None:
    """Replace the file's section `calibration`, or add one; the rest stays as it is."""
    file = file_of(path)
    source = found.robot.source
    before = Calibration() if source is None else read_robot_file(source).calibration
    text = file.read_text(encoding="utf-8")
    section = _section(combined(before, found))
    made, count = _SECTION.subn(lambda _: section, text, count=1)
    if not count:
        made = f"{text.rstrip()}\n\n{_HEAD}{section}"
    write_whole(file, made)


def combined(before: Calibration, found: Calibrated) -> Calibration:
    """The calibration that the views were compared with, and the corrections on top."""
    joints = dict(before.joints)
    for name, zero in zeros(found).items():
        joints[name] = joints.get(name, 0.0) + zero
    old = before.cameras.get(found.camera, CameraCorrection())
    mount = found.solution.state.told[found.parameters.mount]
    pose = Transform.from_rpy(old.xyz, old.rpy) @ mounted(mount)
    x, y, z = (float(value) for value in pose.position)
    correction = CameraCorrection(xyz=(x, y, z), rpy=pose.rpy)
    cameras = {**before.cameras, found.camera: correction}
    return Calibration(joints=joints, cameras=cameras, wheels=_wheels(before.wheels, found))


def _wheels(before: WheelCorrection | None, found: Calibrated) -> WheelCorrection | None:
    """The wheels' corrections on top of those that were there; those if the base did not drive."""
    here = found.parameters.wheels
    if not found.free[here].any():
        return before
    radius, track, larger = (float(value) for value in found.solution.state.told[here])
    between = found.parameters.track
    new = Wheels.of(
        WheelCorrection(radius=radius, track=track, left_to_right=larger, between=between)
    )
    old = Wheels(0.0, 0.0, 0.0, between) if before is None else Wheels.of(before)
    return old.then(new).correction()


def _section(calibration: Calibration) -> str:
    lines = ["calibration:", "  joints:"]
    lines += [f"    {name}: {zero:.6f}" for name, zero in calibration.joints.items()]
    lines.append("  cameras:")
    for name, camera in calibration.cameras.items():
        xyz, rpy = (", ".join(f"{v:.6f}" for v in values) for values in (camera.xyz, camera.rpy))
        lines.append(f"    {name}: {{xyz: [{xyz}], rpy: [{rpy}]}}")
    if calibration.wheels is not None:
        told = (f"{key}: {value:.6f}" for key, value in calibration.wheels)
        lines.append(f"  wheels: {{{', '.join(told)}}}")
    return "\n".join(lines) + "\n"


def file_of(path: Path) -> Path:
    """The robot file that a path means: itself, or the one in the folder."""
    return path / FILE if path.is_dir() else path
