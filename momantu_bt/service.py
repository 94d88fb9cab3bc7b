"""Services, which run all the time, and the interfaces of the two that skills rely on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import getattr_static
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import CameraImage, DetectedObject, RobotState
from momantu_bt.robot import Robot, RobotDescription
from momantu_bt.skill import Clock
from momantu_bt.world import Site


@dataclass(frozen=True, slots=True)
class ServiceContext:
    """What a service receives when the run starts.

    parameters: the site's entry for this service. random: seeded from run seed and service name.
    """

    site: Site
    description: RobotDescription
    frames: FrameBuffer
    clock: Clock
    random: np.random.Generator
    parameters: Mapping[str, Any]
    other: Callable[[str], Any]
    """Another service of this run by name; KeyError when it does not run."""


class Service:
    """Subclass it; `update` is called before the tree's tick, at `rate` Hz of the world's clock.

    publishes: names and types of the keys that trees can read as `$@<service>.<key>`.
    needs: services that this one uses; they start and update before it. senses: kinds of sensors
    that the robot must have, such as `laser`; without one of them the run does not start.
    replaces: services whose place it takes in a run that has it: who needs or reads one of them
    gets this one, which offers and publishes what they do. charts: it makes the run's map itself,
    so the run is told neither a floor plan nor what lies on one.
    An exception in a service ends the run: the robot must not go on without it.
    """

    rate: ClassVar[float] = 20.0
    publishes: ClassVar[Mapping[str, type]] = {}
    needs: ClassVar[tuple[str, ...]] = ()
    senses: ClassVar[tuple[str, ...]] = ()
    replaces: ClassVar[tuple[str, ...]] = ()
    charts: ClassVar[bool] = False

    def start(self, context: ServiceContext) -> None:
        """Called once, before the first update."""
        raise NotImplementedError

    def update(self, robot: Robot, now: float) -> None:
        """Called at `rate`. now: the clock's time, s. Read a sensor only when it is needed."""
        raise NotImplementedError

    def published(self) -> Mapping[str, Any]:
        """Current values of the keys in `publishes`."""
        return {}


class Localization(Protocol):
    """The robot's pose in the map, and how certain it is."""

    @property
    def map_from_base(self) -> Pose2D:
        """The best estimate of the current pose."""
        ...

    @property
    def covariance(self) -> Array:
        """Covariance (3, 3) of x, y, yaw in m2, m rad, rad2."""
        ...

    @property
    def quality(self) -> float:
        """0..1: how well the newest scan fits the map at the estimate."""
        ...

    def reset(self, map_from_base: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Restart around a pose; sigmas are standard deviations in m and rad."""
        ...

    def spread(self) -> None:
        """Restart with guesses spread over all of the map's free floor."""
        ...


@runtime_checkable
class SeveralPlaces(Protocol):
    """A localization that knows of several places where the robot may be."""

    @property
    def places(self) -> tuple[Pose2D, ...]:
        """The places while it searches the whole map, likeliest first; else none."""
        ...


@dataclass(frozen=True, slots=True)
class HeldObject:
    """The object believed to be between the fingers, and its pose in the grasp frame."""

    object: DetectedObject
    grasp_from_object: Transform


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A camera image with the camera's pose, the base's pose and the robot's state at its time."""

    image: CameraImage
    odom_from_camera: Transform
    odom_from_base: Transform
    state: RobotState


class KnowsHeld(Protocol):
    """A service that knows which object the robot believes it holds."""

    @property
    def held(self) -> HeldObject | None:
        """The held object or None; each update checks that the fingers press on something."""
        ...


class PlanningScene(KnowsHeld, Protocol):
    """The robot's belief about its own shape, its surroundings and the object it holds."""

    @property
    def last_contact(self) -> float:
        """Time when the hand last touched or released something, s; -inf before the first time."""
        ...

    def grasped(self, thing: DetectedObject, grasp_from_object: Transform) -> None:
        """Report what the gripper closed on; it is held while the fingers press on something."""
        ...

    def observe(self, snapshot: Snapshot) -> None:
        """Add the obstacles that a camera image shows, for planning the arm's motion."""
        ...

    def footprint(self, state: RobotState, below: float = math.inf) -> Array:
        """Convex outline (k, 2) of base, arm and held object on the floor, base frame, m.

        below: ignore parts of the arm and the held object that are above this height, m.
        """
        ...

    def is_robot(self, points: Array, state: RobotState) -> Any:
        """(n,) bool: which points (n, 3) in the base frame are on the robot or its held object."""
        ...


def offers(service: object, interface: type) -> bool:
    """Whether a service has every member of a Protocol; no property is evaluated."""
    wanted = [name for name in dir(interface) if not name.startswith("_")]
    missing = object()
    return all(getattr_static(service, name, missing) is not missing for name in wanted)
