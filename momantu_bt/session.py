"""An open world with its robot, to work with by hand: from a notebook or a Python shell.

with momantu_bt.open_session(world="office.yaml", robot="my_robot/", seed=3) as session:
    outputs = session.call("nod", angle="20 deg")
    picture = session.picture()
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from types import TracebackType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from momantu_bt.engine.build import skills_in
from momantu_bt.engine.context import Remarked
from momantu_bt.engine.events import Events
from momantu_bt.engine.interrupts import Interrupts
from momantu_bt.engine.skills.services import in_order
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS, Status
from momantu_bt.errors import MomantuError
from momantu_bt.failure import TIMEOUT, Failure, FailureValue
from momantu_bt.faults.stage import Stage
from momantu_bt.formats.names import valid_names
from momantu_bt.messages import CameraImage, RobotState
from momantu_bt.plugins import PluginError
from momantu_bt.robot import CameraSensor, Robot, SensorReading
from momantu_bt.running.assembly import made, program, set_up
from momantu_bt.running.calls import called_skills
from momantu_bt.running.launch import open_world, site_of
from momantu_bt.running.needed import check_parameters, check_sensors, services_of
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import prepare
from momantu_bt.skill import Skill
from momantu_bt.tree.files.given_text import AnyTree, TreeText, tree_source
from momantu_bt.tree.registry import Registry
from momantu_bt.world import Site, Verdict, World

T = TypeVar("T")
NOTHING = TreeText("momantu_bt: 1\ntrees: {Nothing: [succeed]}\n", "<nothing>")
"""The tree of a session into which nothing is loaded."""


class SessionError(MomantuError):
    """The session cannot do this: it is closed, or has no robot, sensor or skill of that name."""


def open_session(
    world: str | World = "none",
    *,
    robot: str | None = None,
    seed: int = 0,
    registry: Registry | None = None,
) -> Session:
    """Open a world with its robot, to work with by hand. Close it, or use it with `with`.

    world: a name, a file, `"none"` for trees without a robot, or an open world, which stays open.
    robot: a name or a file; by default the world's. seed: varies the episode. registry: the skills,
    worlds, robots and services to use; by default everything installed.

    Raises:
        TreeError: there is no such world or robot, or its file has mistakes.
        WorldError: the world could not start.
        LaunchError: the site sets a service wrongly.
    """
    return Session(RunOptions(world=world, robot=robot, seed=seed, patience=float("inf")), registry)


class Session:
    """A world that stays open between trees and calls of skills; `open_session` makes it.

    It is the engine of `momantu_bt.run`, ticked by hand: one tick is 0.05 s of the world's clock,
    and equal calls in equal sessions do the same. Each tree and each call draws random numbers of
    its own; those of the first are the ones of `momantu_bt.run` with this seed. When anything
    raises, also Ctrl-C, all actuators
    are stopped first.
    """

    def __init__(self, options: RunOptions, registry: Registry | None = None) -> None:
        """Use `open_session`."""
        self._options = options
        self._registry = registry if registry is not None else Registry.installed()
        self._stack = ExitStack()
        self._open = True
        self._ended = True
        self._loaded = 0
        self._failure: FailureValue | None = None
        with ExitStack() as opening:
            opening.push(self._stack)
            prepared = prepare(NOTHING, options, self._registry)
            world = open_world(prepared, {}, {}, {})
            if world is not None and world is not options.world:
                self._stack.callback(world.close)
            self._stage = Stage((), world, options.seed, self._stack, site_of(prepared, world))
            events = Events()
            events.subscribe(Remarked, lambda event: options.remark(event.text))
            self._setting = set_up(options, self._stage, {}, {}, events)
            self._start_services(self._usual_services())
            self._run = program(prepared, self._setting, {})
            self._run.begin()
            opening.pop_all()

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Halt what runs, stop the robot and close the world. Calling it twice is safe."""
        if self._open:
            self._open = False
            with self._stack:
                self._run.stop()

    # The robot and its world.

    @property
    def now(self) -> float:
        """Seconds of the world's clock since the session began."""
        return self._setting.context.clock.now()

    @property
    def site(self) -> Site:
        """What the robot is told about its surroundings: map, places, surfaces, objects."""
        return self._world().site

    @property
    def robot(self) -> Robot:
        """The robot's driver. Its `description` lists actuators, sensors and named poses."""
        self._world()
        assert self._stage.robot is not None  # it has one where it has a world
        return self._stage.robot

    def state(self) -> RobotState:
        """The robot's joints, odometry and gripper, as measured now."""
        return self.robot.state()

    def read(self, sensor: str) -> SensorReading:
        """The newest reading of a sensor.

        Raises:
            SessionError: the robot has no such sensor. Failure: SENSOR_DEAD.
        """
        sensors = self.robot.description.sensors
        if sensor not in sensors:
            hint = valid_names(sensor, sensors, "its sensors")
            raise SessionError(f"the robot has no sensor {sensor!r}; {hint}")
        return self.robot.read(sensor)

    def picture(self, camera: str | None = None) -> NDArray[np.uint8]:
        """The picture of a camera, (height, width, 3), RGB. camera: by default the first.

        Raises:
            SessionError: the robot has no such camera. Failure: SENSOR_DEAD.
        """
        sensors = self.robot.description.sensors
        cameras = [name for name, each in sensors.items() if isinstance(each, CameraSensor)]
        if not cameras or (camera is not None and camera not in cameras):
            hint = valid_names(camera or "", cameras, "its cameras")
            raise SessionError(f"the robot has no camera {camera or ''!r}; {hint}")
        image = self.read(camera or cameras[0])
        assert isinstance(image, CameraImage)
        return image.color

    def published(self, service: str) -> Mapping[str, Any]:
        """What a running service publishes, as trees read it at `$@service`.

        Raises:
            SessionError: no service of that name runs; `load` starts those that a tree reads.
        """
        services = self._setting.services
        if service not in services.running:
            hint = valid_names(service, services.running, "running services")
            raise SessionError(f"no service {service!r} runs; {hint}")
        return services.published(service)

    def verdict(self) -> Verdict | None:
        """The referee's judgement now; None without a referee."""
        return self._world().verdict()

    # Trees and skills.

    def load(self, tree: AnyTree, values: Mapping[str, Any] | None = None) -> None:
        """Check a tree, halt the one before it, and make this one ready; `tick` or `run` runs it.

        tree: as for `momantu_bt.run`. values: keys of the root's board.

        Raises:
            TreeError: the tree has errors; all of them are in it.
            LaunchError, CallError: the robot lacks what the tree's skills or services need.
        """
        self._check_open()
        prepared = prepare(tree_source(tree), self._with(values or {}), self._registry)
        kinds = {name: self._registry.skills[name] for name in skills_in(prepared.document)}
        called = called_skills(kinds, self._registry)
        needed = services_of(prepared, {**called, **kinds})
        open_world(prepared, kinds, called, needed)  # it is open; this checks what the robot has
        self._run.stop()
        self._start_services(needed)
        context = self._setting.context
        if context.body is not None:
            context.body = replace(context.body, skills={**context.body.skills, **called})
        context.earlier, self._loaded = self._loaded, self._loaded + 1
        self._run, self._failure = program(prepared, self._setting, kinds), None
        self._run.begin()
        self._ended = False

    def tick(self) -> str:
        """One tick: `RUNNING`, or how the tree ended. Without a tree, time passes: `IDLE`."""
        self._check_open()
        if self._ended:
            self._guarded(self._run.idle)
            return Status.IDLE.value
        status = self._guarded(self._run.tick)
        if status is not RUNNING:
            self._failure = self._run.built.root.failure if status is FAILURE else None
            self._halt()
        return str(status.value)

    def run(self, max_time: float = 600.0) -> str:
        """Tick the loaded tree to its end: `SUCCESS` or `FAILURE`; `failure` then says why.

        max_time: simulated time after which the tree is halted and `RUNNING` returned, s.

        Raises:
            KeyboardInterrupt: Ctrl-C; the tree is halted and the robot stopped.
        """
        until, status = self.now + max_time, RUNNING.value
        with Interrupts() as interrupts:
            interrupts.patient = True
            while status == RUNNING.value and self.now < until - 1e-9:
                status = self.tick()
                if interrupts.requested:
                    self._halt()
                    raise KeyboardInterrupt
        if status == RUNNING.value:
            self._halt()
        return status

    def call(self, skill: str, max_time: float = 600.0, **inputs: Any) -> dict[str, Any]:
        """Run one skill to its end and return its outputs by name.

        inputs: as in a tree (`"50 cm"`, `"table_a"`), or outputs of an earlier call.
        max_time: simulated time after which the skill is halted, s.

        Raises:
            Failure: the skill failed, or was too slow (TIMEOUT); `value` is the whole failure.
            TreeError: there is no such skill or input, or a value does not fit.
        """
        kind = self._registry.skills.get(skill)
        known = {} if kind is None else kind.ports
        outs = {n: f"$out_{n}" for n, port in known.items() if port.direction == "out"}
        ports = {n: _text(v) if isinstance(v, str) else f"$in_{n}" for n, v in inputs.items()}
        values = {f"in_{n}": v for n, v in inputs.items() if not isinstance(v, str)}
        node = {skill: {**ports, **outs}} if ports or outs else skill
        tree = {"momantu_bt": 1, "values": dict.fromkeys(values, 0), "trees": {"Call": [node]}}
        source = tree_source(tree if values else {k: v for k, v in tree.items() if k != "values"})
        assert isinstance(source, TreeText)
        self.load(TreeText(source.text, f"<call {skill}>"), values)
        if self.run(max_time) != SUCCESS.value:
            value = self.failure or FailureValue(
                TIMEOUT, f"{skill} took longer than {max_time:g} s"
            )
            failure = Failure(value.code, value.message, **value.data)
            failure.value = value
            raise failure
        board = self._run.built.board
        return {name: board.get(f"out_{name}") for name in outs if board.has(f"out_{name}")}

    @property
    def failure(self) -> FailureValue | None:
        """Why the loaded tree failed; None if it has not."""
        return self._failure

    @property
    def values(self) -> Mapping[str, Any]:
        """The keys of the loaded tree's board that have a value."""
        return self._run.built.board.values()

    # Parts.

    def _with(self, values: Mapping[str, Any]) -> RunOptions:
        world = "none" if self._stage.world is None else self._stage.world
        return replace(self._options, world=world, robot=None, values=values)

    def _world(self) -> World:
        self._check_open()
        if self._stage.world is None:
            raise SessionError("this session has no robot: open it with world=…")
        return self._stage.world

    def _check_open(self) -> None:
        if not self._open:
            raise SessionError("the session is closed; open another one")

    def _usual_services(self) -> list[str]:
        """The services that installed skills need, if the robot has the sensors and there is a map.

        They run from the start, so that they know of every motion.
        """
        world, found = self._stage.world, list[str]()
        if world is None or world.site.map_file is None:
            return found
        having = {sensor.kind for sensor in world.robot.description.sensors.values()}
        for name in dict.fromkeys(need for kind in self._skills() for need in kind.needs):
            try:
                needed = in_order([name], self._registry.services.__getitem__)
            except (KeyError, PluginError):
                continue  # a skill that needs it says so when it is called
            if any(kind.replaces for kind in needed.values()):
                continue  # it would take the place of another one without having been asked for
            if all(having.issuperset(kind.senses) for kind in needed.values()):
                found.append(name)
        return found

    def _skills(self) -> Iterator[type[Skill]]:
        """The installed skills that are not broken."""
        for name in self._registry.skills:
            with suppress(PluginError):
                yield self._registry.skills[name]

    def _start_services(self, names: Iterable[str]) -> None:
        """Add services that do not run yet; the tree's `begin` starts them."""
        running = self._setting.services
        needed = in_order(names, self._registry.services.__getitem__)
        fresh = {name: kind for name, kind in needed.items() if name not in running.running}
        if fresh:
            check_sensors(fresh, self.robot.description)
            check_parameters(fresh, self.site)
        for name, kind in fresh.items():
            if kind.replaces or kind.charts:
                raise SessionError(
                    f"the service {name!r} takes the place of {', '.join(kind.replaces)}, which a "
                    "session runs from its start; run a tree with momantu_bt.run instead"
                )
            running.add(name, made(name, kind))

    def _guarded(self, step: Callable[[], T]) -> T:
        """One step of the run; if it raises, everything is stopped first."""
        try:
            return step()
        except BaseException:
            self._halt()
            raise

    def _halt(self) -> None:
        self._ended = True
        self._run.stop()


def _text(value: str) -> str:
    """A text as a tree file writes it: a `$` in front would be a key."""
    return value.replace("$", "$$")
