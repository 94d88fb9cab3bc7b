"""One episode in SAPIEN: a scene, a robot, a clock that advances by ticks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sapien

from momantu_bt.robot import CameraSensor, LaserSensor, RobotDescription
from momantu_bt.world import TICK
from momantu_worlds.robots.loading import read_simulation
from momantu_worlds.sapien.building import add_bodies, add_lights
from momantu_worlds.sapien.camera import Camera
from momantu_worlds.sapien.config import STEP, SUB_STEPS, Physics, SimulatorConfig
from momantu_worlds.sapien.laser import Laser
from momantu_worlds.sapien.memory import tidy
from momantu_worlds.sapien.poses import transform_of
from momantu_worlds.sapien.rendering import render_system
from momantu_worlds.sapien.robot import Sensor, SimulatedRobot
from momantu_worlds.sapien.robot_model import RobotModel, build_robot
from momantu_worlds.sapien.truth import Truth
from momantu_worlds.sapien.wrench import Wrench
from momantu_worlds.scenes.bodies import Episode

START_POSE = "home"
"""The named pose in which an episode begins."""


class Simulator:
    """Physics, robot and ground truth of one episode.

    robot: the driver, which is all that skills may see. truth: for the referee and tests.
    model: the robot in SAPIEN, for views.
    """

    def __init__(
        self,
        description: RobotDescription,
        episode: Episode,
        seed: int,
        *,
        render: bool = True,
        config: SimulatorConfig | None = None,
        pose: Mapping[str, float] | None = None,
    ) -> None:
        """Build everything; see `momantu_worlds.sapien.rendering` for what rendering needs.

        render: without it there is no camera, and no Vulkan driver is needed.
        pose: joint positions to begin with; the named pose `home` when None.

        Raises:
            WorldError: the robot cannot be simulated, or SAPIEN cannot render.
        """
        tidy()
        self.config = config or SimulatorConfig()
        self._ticks = 0
        self.scene = _new_scene(self.config.physics, render)
        self._system = self.scene.physx_system
        simulation = read_simulation(description.name)
        model = build_robot(
            self.scene, description, simulation, self.config.physics, visuals=render
        )
        self.truth = Truth(self._system, model, description.base_frame)
        still, moving = add_bodies(self.scene, episode.bodies, self.truth, visuals=render)
        if render:
            add_lights(self.scene, episode)
        self.robot = SimulatedRobot(
            description,
            simulation,
            model,
            episode.start,
            description.named_poses[START_POSE] if pose is None else pose,
            seed,
            self.config,
            self.now,
        )
        for name, sensor in self._sensors(description, model, still, moving, seed, render):
            self.robot.sensors[name] = sensor
        self.model = model
        self._wrists = [s for s in self.robot.sensors.values() if isinstance(s, Wrench)]

    def now(self) -> float:
        """Seconds since the episode began."""
        return round(self._ticks * TICK, 9)

    def step(self) -> None:
        """Advance by one tick: drives act before each of its physics steps."""
        self.robot.begin_tick()
        self.truth.begin_tick()
        for wrist in self._wrists:
            wrist.begin_tick()
        for index in range(SUB_STEPS):
            self.robot.apply(index)
            self._system.step()
            for wrist in self._wrists:
                wrist.collect()
            if self.truth.watching:
                self.truth.collect(last=index == SUB_STEPS - 1)
        self._ticks += 1
        self.robot.end_tick()

    def state_bytes(self) -> bytes:
        """The whole physics state, for comparing two runs bit by bit."""
        return bytes(self._system.pack())

    def close(self) -> None:
        """Empty the scene; safe to call twice."""
        for entity in list(self.scene.entities):
            self.scene.remove_entity(entity)

    def _sensors(
        self,
        description: RobotDescription,
        model: RobotModel,
        still: Any,
        moving: Any,
        seed: int,
        render: bool,
    ) -> list[tuple[str, Sensor]]:
        sensors: list[tuple[str, Sensor]] = []
        for name, spec in description.sensors.items():
            link = model.links[spec.frame]
            if isinstance(spec, CameraSensor):
                if render:
                    errors = self.config.camera
                    links = list(model.links.values())
                    camera = Camera(self.scene, link, name, spec, seed, errors, links)
                    sensors.append((name, camera))
            elif isinstance(spec, LaserSensor):
                where = _pose_source(link)
                laser = Laser(where, name, spec, still, moving, seed, self.config.laser)
                sensors.append((name, laser))
            else:
                wrist = Wrench(model.articulation, link, name, spec, seed, self.config.wrench)
                sensors.append((name, wrist))
        return sensors


def _pose_source(link: Any) -> Any:
    return lambda: transform_of(link.entity_pose)


def _new_scene(physics: Physics, render: bool) -> Any:
    """A scene with our settings, which SAPIEN keeps globally: they are set before each build."""
    body = sapien.physx.PhysxBodyConfig()
    body.solver_position_iterations = physics.position_iterations
    body.solver_velocity_iterations = physics.velocity_iterations
    sapien.physx.set_body_config(body)
    shape = sapien.physx.PhysxShapeConfig()
    shape.contact_offset = physics.contact_offset
    sapien.physx.set_shape_config(shape)
    systems = [sapien.physx.PhysxCpuSystem()]
    if render:
        systems.append(render_system())
    scene = sapien.Scene(systems)
    scene.set_timestep(STEP)
    return scene
