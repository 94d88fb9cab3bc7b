"""Services, which run all the time, and the interfaces of the two that skills rely on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import getattr_static
from typing import Any, ClassVar, Protocol

import numpy as np

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import CameraImage, DetectedObject, RobotState
from momantu_bt.robot import Robot, RobotDescription
from momantu_bt.skill import Clock
from momantu_bt.world import Site


@dataclass(frozen=True, slots=True)
class ServiceContext:
    """What a service receives at the beginning of the run.

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
    """Subclass it; `update` runs before the tree, at `rate` Hz of the world's clock.

    publishes: read-only keys that trees see as `$@<service>.<key>`, with their types.
    needs: services that run before it. senses: kinds of sensors that the robot must have, such as
    `laser`; a run with a robot that lacks one is refused.
    An exception in a service ends the run: the robot must not go on without it.
    """

    rate: ClassVar[float] = 20.0
    publishes: ClassVar[Mapping[str, type]] = {}
    needs: ClassVar[tuple[str, ...]] = ()
    senses: ClassVar[tuple[str, ...]] = ()

    def start(self, context: ServiceContext) -> None:
        """Called once, before the first update."""
        raise NotImplementedError

    def update(self, robot: Robot, now: float) -> None:
        """Called at `rate`; reads sensors only when it needs them."""
        raise NotImplementedError

    def published(self) -> Mapping[str, Any]:
        """Current values of the keys in `publishes`."""
        return {}


class Localization(Protocol):
    """The robot's pose in the map, and how certain it is."""

    @property
    def map_from_base(self) -> Pose2D:
        """The best estimate of now."""
        ...

    @property
    def covariance(self) -> Array:
        """(3, 3) of x, y, yaw in m2, m rad, rad2."""
        ...

    @property
    def quality(self) -> float:
        """0..1: how well the newest scan fits the map at the estimate."""
        ...

    def reset(self, map_from_base: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Start over around a pose; standard deviations in m and rad."""
        ...

    def spread(self) -> None:
        """Start over everywhere on the map's free floor."""
        ...


@dataclass(frozen=True, slots=True)
class HeldObject:
    """The object believed to be between the fingers, and its pose in the grasp frame."""

    object: DetectedObject
    grasp_from_object: Transform


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A camera's picture with what was true when it was taken."""

    image: CameraImage
    odom_from_camera: Transform
    odom_from_base: Transform
    state: RobotState


class KnowsHeld(Protocol):
    """The object that the robot believes to hold."""

    @property
    def held(self) -> HeldObject | None:
        """The held object, judged again at each update from gripper width and effort."""
        ...


class PlanningScene(KnowsHeld, Protocol):
    """The robot, its surroundings and what it holds, as believed."""

    @property
    def last_contact(self) -> float:
        """When the hand last touched or released something, s; -inf when it never has."""
        ...

    def grasped(self, thing: DetectedObject, grasp_from_object: Transform) -> None:
        """Say what the gripper closed on; it counts as held while width and effort agree."""
        ...

    def observe(self, snapshot: Snapshot) -> None:
        """Take over what a picture shows: what an arm may meet."""
        ...

    def footprint(self, state: RobotState, below: float = math.inf) -> Array:
        """Convex outline (k, 2) of base, arm and held object on the floor, base frame, m.

        below: parts of arm and load that keep above this height, m, are left out.
        """
        ...

    def is_robot(self, points: Array, state: RobotState) -> Any:
        """(n,) bool: which points (n, 3) in the base frame are on the robot or its held object."""
        ...


def offers(service: object, interface: type) -> bool:
    """Whether a service has all that a Protocol names; none of it is evaluated."""
    wanted = [name for name in dir(interface) if not name.startswith("_")]
    missing = object()
    return all(getattr_static(service, name, missing) is not missing for name in wanted)
