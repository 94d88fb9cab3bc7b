"""Read a robot file: from YAML and URDFs to a description, with every error at its place."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from momantu_bt.descriptions.reading import Reading, read_text
from momantu_bt.descriptions.validation import checked
from momantu_bt.robot import RobotDescription
from momantu_bt.robot_parts import BaseLimits
from momantu_bt.robot_simulation import JointGains, PlanarDrive, SimulationModel
from momantu_bt.robots.assembly import Assembled, assemble, keep_urdf
from momantu_bt.robots.calibrated import corrected
from momantu_bt.robots.checks import findings
from momantu_bt.robots.errors import PartError, RobotFileError
from momantu_bt.robots.robot_file import Calibration, RobotFile

FILE = "robot.yaml"


def read_robot(path: Path) -> RobotDescription:
    """The robot that a file describes, its parts assembled into one URDF.

    path: a folder with `robot.yaml`, or a robot file.

    Raises:
        RobotNotInstalled: its files are in a Python package that is not installed.
        RobotFileError: the file, or one that it names, is missing or wrong; the message gives every
        problem with line and column.
    """
    reading, robot = _read(path)
    file = reading.path.absolute()
    try:
        assembled = assemble(robot, file.parent)
        believed = _calibrated(robot, assembled)
    except ExceptionGroup as group:
        troubles = [e for e in group.exceptions if isinstance(e, PartError)]
        reading.refuse((trouble.place, trouble.message) for trouble in troubles)
        raise
    reading.refuse(findings(robot, assembled.root, reading))
    return _description(robot, file, assembled, believed)


def read_robot_file(path: Path) -> RobotFile:
    """A robot file without its parts; `path` and errors as in `read_robot`."""
    return _read(path)[1]


def _read(path: Path) -> tuple[Reading, RobotFile]:
    file = path / FILE if path.is_dir() else path
    reading = Reading(file, read_text(file, RobotFileError), RobotFileError)
    return reading, checked(reading, RobotFile, RobotFileError)


def _calibrated(robot: RobotFile, assembled: Assembled) -> Path:
    """The URDF that skills believe: the assembled one, or a corrected copy of it."""
    if robot.calibration == Calibration():
        return assembled.path
    root = corrected(robot, assembled.root)
    return keep_urdf(robot.name, etree.tostring(root, encoding="utf-8"))


def _description(
    robot: RobotFile, file: Path, assembled: Assembled, believed: Path
) -> RobotDescription:
    return RobotDescription(
        name=robot.name,
        source=file,
        files={file.name: file, **assembled.files},
        urdf=believed,
        mesh_directories=_mesh_directories(assembled, believed),
        base_frame=robot.base_frame,
        footprint=robot.footprint,
        height=robot.height,
        working=robot.working,
        base=BaseLimits(**robot.base.model_dump(exclude={"drive"})),
        actuators=robot.actuators,
        joint_limits=robot.joint_limits,
        sensors=robot.sensors,
        groups=robot.groups,
        end_effector=robot.end_effector,
        named_poses=robot.named_poses,
        ignored_collisions=robot.ignored_collisions,
        wheels=robot.calibration.wheels,
        simulation=_simulation(robot, assembled),
    )


def _mesh_directories(assembled: Assembled, believed: Path) -> tuple[Path, ...]:
    """Where the URDF's meshes are; a corrected copy lies elsewhere than its meshes."""
    own = assembled.path.parent
    if believed == assembled.path or own in assembled.mesh_directories:
        return assembled.mesh_directories
    return (*assembled.mesh_directories, own)


def _simulation(robot: RobotFile, assembled: Assembled) -> SimulationModel | None:
    drive, contacts = robot.base.drive, robot.simulation
    if drive is None or contacts is None or assembled.base_joints is None:
        return None
    base = PlanarDrive(joints=assembled.base_joints, force=drive.force, torque=drive.torque)
    own = None if robot.calibration == Calibration() else assembled.path
    return SimulationModel(base=base, drives=_drives(robot), urdf=own, **dict(contacts))


def _drives(robot: RobotFile) -> dict[str, JointGains]:
    """Gains by joint: those of its actuator, and its own in their place."""
    gains: dict[str, JointGains] = {}
    for name, actuator in robot.actuators.items():
        for joint in actuator.joints if name in robot.drives else ():
            gains[joint] = robot.drives[name]
    for name, own in robot.drives.items():
        if name not in robot.actuators:
            given = own.model_dump(exclude_none=True)
            gains[name] = gains.get(name, JointGains()).model_copy(update=given)
    return gains
