"""The URDF of a robot as it was calibrated: joints and cameras moved to where they really are."""

from __future__ import annotations

import copy
from collections.abc import Iterator

import numpy as np
from lxml import etree

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.urdf import Urdf
from momantu_bt.frames import Joint
from momantu_bt.geometry import Transform, quaternion_from_axis_angle
from momantu_bt.robot_parts import CameraSensor
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.joining import numbers
from momantu_bt.robots.robot_file import RobotFile


def corrected(robot: RobotFile, root: etree._Element) -> etree._Element:
    """A copy of an assembled URDF's element with the file's `calibration`.

    Raises:
        ExceptionGroup[PartError]: it names a joint or a camera that does not fit.
    """
    made = copy.deepcopy(root)
    elements = {str(each.get("name")): each for each in made.findall("joint")}
    joints = [Joint.of_urdf(joint) for joint in Urdf(made).joints]
    troubles = list(_zeros(robot, elements, joints)) + list(_cameras(robot, elements, joints))
    if troubles:
        raise ExceptionGroup("the calibration does not fit the robot", troubles)
    return made


def _zeros(
    robot: RobotFile, elements: dict[str, etree._Element], joints: list[Joint]
) -> Iterator[PartError]:
    moving = {joint.name: joint for joint in joints if joint.kind != "fixed"}
    for name, zero in robot.calibration.joints.items():
        place: KeyPath = ("calibration", "joints", name)
        if name not in moving:
            known = valid_names(name, moving, "joints that move")
            yield PartError(place, f"there is no joint {name!r} that moves; {known}")
            continue
        joint = moving[name]
        axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
        slides = joint.kind == "prismatic"
        move = (
            Transform(axis * zero)
            if slides
            else Transform((0.0, 0.0, 0.0), quaternion_from_axis_angle(axis, zero))
        )
        _place(elements[name], joint.parent_from_joint @ move)


def _cameras(
    robot: RobotFile, elements: dict[str, etree._Element], joints: list[Joint]
) -> Iterator[PartError]:
    above = {joint.child: joint for joint in joints}
    cameras = {k: s for k, s in robot.sensors.items() if isinstance(s, CameraSensor)}
    for name, correction in robot.calibration.cameras.items():
        place: KeyPath = ("calibration", "cameras", name)
        if name not in cameras:
            known = valid_names(name, cameras, "cameras")
            yield PartError(place, f"there is no camera {name!r}; {known}")
            continue
        joint = above.get(cameras[name].frame)
        if joint is None or joint.kind != "fixed":
            yield PartError(
                place,
                f"the frame {cameras[name].frame!r} hangs on no fixed joint, so that it cannot be "
                "moved; give the camera a frame of its own under `frames`",
            )
            continue
        move = Transform.from_rpy(correction.xyz, correction.rpy)
        _place(elements[joint.name], joint.parent_from_joint @ move)


def _place(element: etree._Element, pose: Transform) -> None:
    """Give a joint's element another origin."""
    origin = element.find("origin")
    if origin is None:
        origin = etree.Element("origin")
        element.insert(0, origin)
    origin.set("xyz", numbers(pose.position))
    origin.set("rpy", numbers(pose.rpy))
