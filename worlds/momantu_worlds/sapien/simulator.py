"""One episode in SAPIEN: a scene, a robot, a clock that advances by ticks."""

from __future__ import annotations

import ctypes
import gc
from collections.abc import Callable, Mapping
from itertools import count
from pathlib import Path
from typing import Any

import sapien

from momantu_bt.geometry import Transform
from momantu_bt.robot import RobotDescription, SimulationModel
from momantu_bt.world import TICK, WorldError
from momantu_worlds.sapien.build.bodies import Addition, add_bodies, add_body, add_lights
from momantu_worlds.sapien.build.robot_model import build_robot
from momantu_worlds.sapien.build.truth import Truth
from momantu_worlds.sapien.config import STEP, SUB_STEPS, Physics, SimulatorConfig
from momantu_worlds.sapien.poses import pose_of
from momantu_worlds.sapien.robot import SimulatedRobot
from momantu_worlds.sapien.sensors.builder import SensorBuilder
from momantu_worlds.sapien.sensors.imu import Imu
from momantu_worlds.sapien.sensors.lidar import Lidar
from momantu_worlds.sapien.sensors.wrench import Wrench
from momantu_worlds.scenes.geometry.bodies import Body, Episode

START_POSE = "home"
"""The named pose in which an episode begins."""
SHADERS = Path(__file__).parent / "shaders" / "lambert"
_OPENED = count()
"""How many episodes this process has opened: before the first there is nothing to tidy."""


class Simulator:
    """Physics, robot and ground truth of one episode.

    robot: the driver, the only part that skills may see. truth: for the referee and tests. model:
    the robot in SAPIEN, for views. before_tick, before_step: called before each tick and, with its
    number, before each physics step, by those who move bodies.
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
        """Build everything; see `render_system` for what rendering needs.

        render: without it there is no camera, and no Vulkan driver is needed.
        pose: joint positions to begin with; the named pose `home` when None.

        Raises:
            WorldError: the robot cannot be simulated, or SAPIEN cannot render.
        """
        if next(_OPENED) > 0:
            tidy()
        self.config = config or SimulatorConfig()
        self._ticks, self._now = 0, 0.0
        self.scene = _new_scene(self.config.physics, render)
        self._system = self.scene.physx_system
        simulation = _simulation_of(description)
        model = build_robot(
            self.scene, description, simulation, self.config.physics, visuals=render
        )
        self.truth = Truth(self._system, model, description.base_frame)
        still, self._moving = add_bodies(self.scene, episode.bodies, self.truth, visuals=render)
        self._added: dict[str, Addition] = {}
        self.before_tick: list[Callable[[], None]] = []
        self.before_step: list[Callable[[int], None]] = []
        self._render = render
        if render:
            add_lights(self.scene, episode)
        self.robot = SimulatedRobot(
            description,
            simulation,
            model,
            episode.start,
            description.named_poses.get(START_POSE, {}) if pose is None else pose,
            seed,
            self.config,
            self.now,
        )
        builder = SensorBuilder(
            self.scene, description, model, still, self._moving, seed, self.config
        )
        self.robot.sensors.update(builder.build(render=render))
        self.model = model
        self._wrists = [s for s in self.robot.sensors.values() if isinstance(s, Wrench)]
        self._sampled = [s for s in self.robot.sensors.values() if isinstance(s, Imu | Lidar)]

    def now(self) -> float:
        """Seconds since the episode began."""
        return self._now

    def step(self) -> None:
        """Advance by one tick: drives act before each of its physics steps."""
        for plan in self.before_tick:
            plan()
        self.robot.begin_tick()
        self.truth.begin_tick()
        for wrist in self._wrists:
            wrist.begin_tick()
        for index in range(SUB_STEPS):
            self.robot.apply(index)
            for move in self.before_step:
                move(index)
            self._system.step()
            for wrist in self._wrists:
                wrist.collect()
            if self.truth.watching:
                self.truth.collect(last=index == SUB_STEPS - 1)
            for sensor in self._sampled:
                if sensor.asked:
                    sensor.collect(self._now + (index + 1) * STEP)
        self._ticks += 1
        self._now = round(self._ticks * TICK, 9)
        self.robot.end_tick()

    @property
    def added(self) -> tuple[Body, ...]:
        """Bodies that were added since the episode began and not removed."""
        return tuple(addition.body for addition in self._added.values())

    def add(self, body: Body) -> None:
        """Add a body to the running world: it collides, blocks lasers and is visible.

        Raises:
            ValueError: a body of that name exists.
        """
        if body.name in self.truth.bodies:
            raise ValueError(f"there is a body {body.name!r} already")
        addition = add_body(self.scene, body, self.truth, visuals=self._render)
        self._added[body.name] = addition
        if addition.moving is not None:
            self._moving.append(addition.moving)

    def remove(self, name: str) -> None:
        """Remove an added body; KeyError if no body of that name was added."""
        addition = self._added.pop(name)
        if addition.moving is not None:
            self._moving.remove(addition.moving)
        self.truth.forget(name)
        self.scene.remove_entity(addition.entity)

    def put(self, name: str, map_from_body: Transform) -> None:
        """Move a loose body elsewhere, at rest."""
        entity = self.truth.entity(name)
        entity.set_pose(pose_of(map_from_body))
        part = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        part.set_linear_velocity([0.0, 0.0, 0.0])
        part.set_angular_velocity([0.0, 0.0, 0.0])
        part.wake_up()

    def state_bytes(self) -> bytes:
        """The whole physics state, for comparing two runs bit by bit."""
        return bytes(self._system.pack())

    def close(self) -> None:
        """Empty the scene; safe to call twice."""
        for entity in list(self.scene.entities):
            self.scene.remove_entity(entity)


def _simulation_of(description: RobotDescription) -> SimulationModel:
    if description.simulation is None:
        where = description.source or f"the description of {description.name}"
        raise WorldError(
            f"the robot {description.name!r} cannot be simulated: {where} needs a section "
            "`simulation` and, under `base`, a `drive`"
        )
    return description.simulation


def _new_scene(physics: Physics, render: bool) -> Any:
    """Create a scene with this project's settings; SAPIEN keeps them globally."""
    sapien.physx.set_scene_config(enable_pcm=physics.persistent_contacts)
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


def tidy() -> None:
    """Collect reference cycles, which keep closed scenes alive, and return free memory.

    Otherwise a process that runs many episodes grows. Scenes hold buffers that Python does not
    count. It therefore collects them late, between allocations that stay.
    """
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc alone has it
    if trim is not None:
        trim(0)


def render_system() -> Any:
    """A render system with this project's shaders: one pass, Lambert, no shadows.

    Raises:
        WorldError: SAPIEN finds no rendering device.
    """
    sapien.render.set_log_level("error")
    sapien.render.set_camera_shader_dir(str(SHADERS))
    sapien.render.set_picture_format("Color", "r8g8b8a8unorm")
    try:
        return sapien.render.RenderSystem()
    except RuntimeError as error:
        raise WorldError(
            f"SAPIEN cannot render: {error}. It needs a Vulkan driver, in software at least; "
            "`make setup` brings one without touching the system, and `momantu-bt doctor` says "
            "what is missing"
        ) from None
