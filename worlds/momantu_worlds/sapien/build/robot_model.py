"""Building a robot from its URDF: collision filters, drives, coupled fingers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np
import sapien
from sapien.wrapper.urdf_loader import URDFLoader

from momantu_bt.geometry import Array
from momantu_bt.robot import ActuatorKind, Cuts, RobotDescription, SimulationModel
from momantu_worlds.sapien.build import robot_meshes
from momantu_worlds.sapien.build.cells import convex_cells
from momantu_worlds.sapien.build.collision_filter import FLOOR_BIT, ignore_bits
from momantu_worlds.sapien.config import Physics
from momantu_worlds.sapien.drives.fingers import Finger, couple, fingers_of
from momantu_worlds.sapien.drives.followers import Follower, mimicking, unused_grippers
from momantu_worlds.sapien.drives.gains import Gains, arm_gains

MANY_TURNS = 1e3
"""Limit of joints that turn without end, rad, so that positions never wrap."""
LIMITED = ("revolute_unwrapped", "prismatic")
"""Types of joints that have a range, as SAPIEN names them."""
FLOOR_REACH = 1e3
"""Range of the base's virtual sliding joints, m."""


@dataclass
class RobotModel:
    """A robot in the physics scene.

    joints: active joints by name. index: their index in qpos. links: by name. gains: of each arm
    and head joint, and of finger tips. fingers: the gripper's, by joint. mimics: joints that mimic
    others, without the gripper's. idle: joints of grippers that nobody moves, held still.
    """

    articulation: Any
    joints: dict[str, Any]
    index: dict[str, int]
    links: dict[str, Any]
    gains: Mapping[str, Gains]
    fingers: Mapping[str, Finger]
    mimics: Mapping[str, Follower]
    idle: tuple[str, ...] = ()

    def positions(self) -> Array:
        """All true joint positions now (dof,)."""
        return np.asarray(self.articulation.get_qpos(), dtype=np.float64)

    def velocities(self) -> Array:
        """All true joint velocities now (dof,)."""
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

    visuals: whether to load visual shapes; impossible in a scene without a renderer.

    Raises:
        WorldError: a mesh file cannot be read.
    """
    builder = _parse(scene, description, simulation, visuals)
    cells = {
        name: _take_cells(builder, name, cuts) for name, cuts in simulation.convex_cells.items()
    }
    articulation = robot_meshes.built(builder)
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
    index = {name: i for i, name in enumerate(joints)}
    model = RobotModel(
        articulation,
        joints,
        index,
        {link.name: link for link in articulation.get_links()},
        arm_gains(description, simulation, physics),
        fingers_of(description, simulation, joints, physics),
        mimicking(description, joints, index, physics),
    )
    model.idle = tuple(
        name
        for actuator in unused_grippers(description).values()
        for name in actuator.joints
        if name not in model.mimics
    )
    _set_drives(model, description, simulation, physics)
    couple(articulation, model.fingers, physics)
    return model


class _UnseenLoader(URDFLoader):  # type: ignore[misc]
    """Leaves out visual shapes: without a renderer not even a colour can be created."""

    def _build_link(self, link: Any, link_builder: Any) -> None:
        link.visuals = []
        super()._build_link(link, link_builder)


def _parse(
    scene: Any, description: RobotDescription, simulation: SimulationModel, visuals: bool
) -> Any:
    loader = URDFLoader() if visuals else _UnseenLoader()
    loader.set_scene(scene)
    loader.fix_root_link = True
    for link in simulation.finger_links:
        friction = simulation.finger_friction
        loader.set_link_material(link, friction, friction, 0.0)
    articulations, _, _ = loader.parse(str(simulation.urdf or description.urdf), srdf_file="")
    builder = articulations[0]
    own = {} if description.end_effector is None else description.hand.opening
    builder.mimic_joint_records = []  # drives move them: tendons pull the leader along
    links = {link.name: link for link in builder.link_builders}
    for link in builder.link_builders:
        if link.name in simulation.no_collision_links:
            link.collision_records.clear()
        _unwrap(link.joint_record, simulation)
        give_room(link.joint_record, own)
    for name in simulation.floor_links:
        links[name].collision_groups[2] |= FLOOR_BIT
    _ignore_pairs(links, (*description.ignored_collisions, *simulation.ignored_collisions))
    return builder


def _take_cells(builder: Any, name: str, cuts: Cuts) -> list[Any]:
    """Replace a link's collision mesh by hulls of its cells, to be attached after it is built."""
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


def give_room(joint: Any, opening: Mapping[str, Sequence[tuple[float, float]]]) -> None:
    """Let a finger joint take every position of its opening.

    The range of a joint that follows another one may be written for the other way round.
    """
    if joint.name not in opening or joint.joint_type not in LIMITED:
        return
    low, high = joint.limits[0]
    positions = [position for _, position in opening[joint.name]]
    joint.limits = [[min(low, *positions), max(high, *positions)]]


def _ignore_pairs(links: dict[str, Any], pairs: tuple[tuple[str, str], ...]) -> None:
    """Ignore collisions of these pairs, and of links that share a joint or have one between them.

    SAPIEN itself ignores a link and its parent.
    """
    apart = [*pairs, *_neighbours(links)]
    unknown = [
        (first, second)
        for first, second in apart
        if links[first].parent is not links[second] and links[second].parent is not links[first]
    ]
    for name, bits in ignore_bits(unknown).items():
        links[name].collision_groups[2] |= bits


def _neighbours(links: dict[str, Any]) -> list[tuple[str, str]]:
    """Pairs of colliding links with no joint, or only one, between them."""
    bodies: dict[Any, list[str]] = {}
    for name, link in links.items():
        if link.collision_records:
            bodies.setdefault(_body(link), []).append(name)
    pairs = [pair for names in bodies.values() for pair in combinations(names, 2)]
    for body, names in bodies.items():
        if body.parent is not None:
            pairs += product(names, bodies.get(_body(body.parent), ()))
    return pairs


def _body(link: Any) -> Any:
    """The topmost link that is fixed to this one."""
    while link.parent is not None and link.joint_record.joint_type == "fixed":
        link = link.parent
    return link


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
                model.gains[name].give(model.joints[name])
    for name in model.idle:
        model.gains[name].give(model.joints[name])
