"""Read a robot file: from YAML and URDFs to a description, with every error at its place."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.descriptions.reading import Reading, read_text
from momantu_bt.descriptions.validation import checked
from momantu_bt.robot import RobotDescription
from momantu_bt.robot_parts import BaseLimits
from momantu_bt.robot_simulation import JointGains, PlanarDrive, SimulationModel
from momantu_bt.robots.assembly import Assembled, assemble
from momantu_bt.robots.checks import findings
from momantu_bt.robots.errors import PartError, RobotFileError
from momantu_bt.robots.robot_file import RobotFile

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
    except ExceptionGroup as group:
        troubles = [e for e in group.exceptions if isinstance(e, PartError)]
        reading.refuse((trouble.place, trouble.message) for trouble in troubles)
        raise
    reading.refuse(findings(robot, assembled.root, reading))
    return _description(robot, file, assembled)


def read_robot_file(path: Path) -> RobotFile:
    """A robot file without its parts; `path` and errors as in `read_robot`."""
    return _read(path)[1]


def _read(path: Path) -> tuple[Reading, RobotFile]:
    file = path / FILE if path.is_dir() else path
    reading = Reading(file, read_text(file, RobotFileError), RobotFileError)
    return reading, checked(reading, RobotFile, RobotFileError)


def _description(robot: RobotFile, file: Path, assembled: Assembled) -> RobotDescription:
    return RobotDescription(
        name=robot.name,
        source=file,
        files={file.name: file, **assembled.files},
        urdf=assembled.path,
        mesh_directories=assembled.mesh_directories,
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
        simulation=_simulation(robot, assembled),
    )


def _simulation(robot: RobotFile, assembled: Assembled) -> SimulationModel | None:
    drive, contacts = robot.base.drive, robot.simulation
    if drive is None or contacts is None or assembled.base_joints is None:
        return None
    base = PlanarDrive(joints=assembled.base_joints, force=drive.force, torque=drive.torque)
    return SimulationModel(base=base, drives=_drives(robot), **dict(contacts))


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
