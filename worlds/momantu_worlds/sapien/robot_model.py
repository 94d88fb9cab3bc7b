"""Building a robot from its URDF: collision filters, drives, coupled fingers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import sapien
from lxml import etree

from momantu_bt.geometry import Array
from momantu_bt.robot import ActuatorKind, Cuts, RobotDescription, SimulationModel
from momantu_worlds.sapien.cells import convex_cells
from momantu_worlds.sapien.config import Physics

FLOOR_BIT = 1 << 30
"""Collision bit of what a base may roll on: shapes that share it ignore each other."""
MANY_TURNS = 1e3
"""rad; the limit given to joints that turn for ever, so that positions never wrap."""
FLOOR_REACH = 1e3
"""m; how far the slides of the base go."""


@dataclass
class RobotModel:
    """A robot in the physics scene.

    joints: active joints by name. index: their place in qpos. links: by name.
    efforts: force or torque limit of each arm and head joint.
    """

    articulation: Any
    joints: dict[str, Any]
    index: dict[str, int]
    links: dict[str, Any]
    efforts: dict[str, float]

    def positions(self) -> Array:
        """All joint positions now (dof,), true."""
        return np.asarray(self.articulation.get_qpos(), dtype=np.float64)

    def velocities(self) -> Array:
        """All joint velocities now (dof,), true."""
        return np.asarray(self.articulation.get_qvel(), dtype=np.float64)


def build_robot(
    scene: Any,
    description: RobotDescription,
    simulation: SimulationModel,
    physics: Physics,
    *,
    visuals: bool,
) -> RobotModel:
    """Load the robot with its base at the origin.

    visuals: whether to load what cameras see; impossible in a scene without a renderer.
    """
    builder = _parse(scene, description, simulation, visuals)
    cells = {
        name: _take_cells(builder, name, cuts) for name, cuts in simulation.convex_cells.items()
    }
    articulation = builder.build(fix_root_link=True)
    for name, shapes in cells.items():
        for shape in shapes:
            articulation.find_link_by_name(name).attach(shape)
    articulation.set_name(description.name)
    articulation.set_sleep_threshold(0.0)
    articulation.set_solver_position_iterations(physics.position_iterations)
    articulation.set_solver_velocity_iterations(physics.velocity_iterations)
    for link in articulation.get_links():
        link.set_disable_gravity(True)
    joints = {joint.name: joint for joint in articulation.get_active_joints()}
    model = RobotModel(
        articulation,
        joints,
        {name: i for i, name in enumerate(joints)},
        {link.name: link for link in articulation.get_links()},
        _efforts(description),
    )
    _set_drives(model, description, simulation, physics)
    _couple_fingers(model, description, simulation, physics)
    return model


def _parse(
    scene: Any, description: RobotDescription, simulation: SimulationModel, visuals: bool
) -> Any:
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    for link in simulation.finger_links:
        friction = simulation.finger_friction
        loader.set_link_material(link, friction, friction, 0.0)
    articulations, _, _ = loader.parse(str(description.urdf), srdf_file="")
    builder = articulations[0]
    links = {link.name: link for link in builder.link_builders}
    for link in builder.link_builders:
        if not visuals:
            link.visual_records.clear()
        if link.name in simulation.no_collision_links:
            link.collision_records.clear()
        _unwrap(link.joint_record, simulation)
    for name in simulation.floor_links:
        links[name].collision_groups[2] |= FLOOR_BIT
    _ignore_pairs(links, description.ignored_collisions)
    return builder


def _take_cells(builder: Any, name: str, cuts: Cuts) -> list[Any]:
    """Replace a link's collision mesh by hulls of its cells, to be attached once it is built."""
    link = next(link for link in builder.link_builders if link.name == name)
    shapes = []
    for record in link.collision_records:
        for vertices in convex_cells(record.filename, cuts):
            shape = sapien.physx.PhysxCollisionShapeConvexMesh(
                vertices=vertices, scale=record.scale, material=record.material
            )
            shape.local_pose = record.pose
            shape.set_collision_groups(link.collision_groups)
            shapes.append(shape)
    link.collision_records.clear()
    return shapes


def _unwrap(joint: Any, simulation: SimulationModel) -> None:
    base = simulation.base.joints
    if joint.joint_type == "revolute":
        joint.joint_type = "revolute_unwrapped"
        joint.limits = [[-MANY_TURNS, MANY_TURNS]]
    elif joint.name in (base.x, base.y):
        joint.limits = [[-FLOOR_REACH, FLOOR_REACH]]


def _ignore_pairs(links: dict[str, Any], pairs: tuple[tuple[str, str], ...]) -> None:
    """Give each ignored pair a bit of its own (collision group 2)."""
    bit = 0
    for first, second in pairs:
        if links[first].parent is links[second] or links[second].parent is links[first]:
            continue
        for name in (first, second):
            links[name].collision_groups[2] |= 1 << bit
        bit += 1


def _efforts(description: RobotDescription) -> dict[str, float]:
    root = etree.fromstring(description.urdf.read_bytes())
    efforts: dict[str, float] = {}
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        if limit is not None and limit.get("effort") is not None:
            efforts[str(joint.get("name"))] = float(str(limit.get("effort")))
    return efforts


def _set_drives(
    model: RobotModel, description: RobotDescription, simulation: SimulationModel, physics: Physics
) -> None:
    base = simulation.base.joints
    for name, most in (
        (base.x, simulation.base.force),
        (base.y, simulation.base.force),
        (base.yaw, simulation.base.torque),
    ):
        model.joints[name].set_drive_property(0.0, physics.base_damping, most)
        model.joints[name].set_friction(0.0)
    for actuator in description.actuators.values():
        if actuator.kind is ActuatorKind.JOINTS:
            for name in actuator.joints:
                model.joints[name].set_drive_property(
                    physics.arm_stiffness,
                    physics.arm_damping,
                    model.efforts.get(name, math.inf),
                )


def _couple_fingers(
    model: RobotModel, description: RobotDescription, simulation: SimulationModel, physics: Physics
) -> None:
    """Make both fingers move alike: the difference of their travels is held at zero."""
    if len(simulation.finger_links) != 2:
        return
    first, second = (model.links[name] for name in simulation.finger_links)
    model.articulation.create_fixed_tendon(
        [first.get_parent(), first, second],
        [0, 1, -1],
        [0, 1, -1],
        rest_length=0,
        offset=0,
        stiffness=physics.tendon_stiffness,
        damping=physics.tendon_damping,
    )
