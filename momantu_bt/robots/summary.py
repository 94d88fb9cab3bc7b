"""A robot's summary: parts, masses, reach, heights of sensors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from momantu_bt.formats.urdf import Urdf, read_urdf
from momantu_bt.robot import RobotDescription, laser_band
from momantu_bt.robot_parts import CameraSensor, LaserSensor, Sensor
from momantu_bt.robots.assembly import load_parts
from momantu_bt.robots.reader import read_robot_file

HOME = "home"
"""The named pose for the heights of sensors."""


def summary(description: RobotDescription) -> dict[str, Any]:
    """Plain data for JSON and for `robots show`; SI units.

    Raises:
        RobotFileError: its file was changed since it was read, and is wrong.
    """
    xs, ys = zip(*description.footprint, strict=True)
    return {
        "name": description.name,
        "file": None if description.source is None else str(description.source),
        "urdf": str(description.urdf),
        "mass": read_urdf(description.urdf).mass,
        "height": description.height,
        "base_frame": description.base_frame,
        "footprint": {"length": max(xs) - min(xs), "width": max(ys) - min(ys)},
        "parts": dict(_parts(description)),
        "base": description.base.model_dump(),
        "working": description.working.model_dump(),
        "actuators": {k: a.model_dump(mode="json") for k, a in description.actuators.items()},
        "joint_limits": dict(_limits(description)),
        "sensors": {k: _sensor(description, k, s) for k, s in description.sensors.items()},
        "groups": {
            k: {**g.model_dump(), "stretched": _stretched(description, k)}
            for k, g in description.groups.items()
        },
        "end_effector": description.end_effector and description.end_effector.model_dump(),
        "named_poses": description.named_poses,
        "simulated": description.simulation is not None,
    }


def _parts(description: RobotDescription) -> Iterator[tuple[str, dict[str, Any]]]:
    """The parts of a robot file; nothing of a description that has none."""
    if description.source is None:
        return
    robot, folder = read_robot_file(description.source), description.source.absolute().parent
    for part in load_parts(robot, folder):
        urdf = Urdf(part.root)
        mount = robot.mounts.get(part.name)
        yield (
            part.name,
            {
                "file": str(part.path),
                "namespace": part.source.namespace,
                "meshes": None if part.meshes is None else str(part.meshes),
                "links": len(urdf.links),
                "moving_joints": sum(joint.kind != "fixed" for joint in urdf.joints),
                "mass": urdf.mass,
                "mount": None if mount is None else mount.model_dump(),
            },
        )


def _limits(description: RobotDescription) -> Iterator[tuple[str, dict[str, Any]]]:
    slides = {j.name for j in description.kinematics().joints() if j.kind == "prismatic"}
    for name, limit in description.joint_limits.items():
        yield name, {**limit.model_dump(), "unit": "m" if name in slides else "rad"}


def _sensor(description: RobotDescription, name: str, sensor: Sensor) -> dict[str, Any]:
    """A sensor's own fields, and its height above the floor in the pose `home`."""
    pose = description.named_poses.get(HOME, {})
    place = description.kinematics().base_from_frame(sensor.frame, pose).position
    told = {**sensor.model_dump(mode="json", exclude_none=True), "height_at_home": float(place[2])}
    if isinstance(sensor, CameraSensor):
        told["picture_height"] = told.pop("height")
    if isinstance(sensor, LaserSensor) and name == description.laser()[0]:
        told["sees_heights"] = laser_band(description)
    return told


def _stretched(description: RobotDescription, group: str) -> float:
    """Distance of the tip from the group's first joint that no posture can pass, m."""
    chain = description.kinematics().chain(description.groups[group].tip)
    first = next(i for i, joint in enumerate(chain) if joint.kind != "fixed")
    links = (
        float(np.linalg.norm(joint.parent_from_joint.position)) for joint in chain[first + 1 :]
    )
    limits = description.joint_limits
    slides = [limits[j.name] for j in chain if j.kind == "prismatic" and j.name in limits]
    return sum(links) + sum(max(abs(s.lower or 0.0), abs(s.upper or 0.0)) for s in slides)
