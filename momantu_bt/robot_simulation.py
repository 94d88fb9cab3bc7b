"""What a simulator needs to know about a robot, and skills must not know."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import Field

from momantu_bt.descriptions.quantities import Angle, Force, Length
from momantu_bt.robot_parts import Part

Gain: TypeAlias = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Strength: TypeAlias = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class BaseJoints(Part):
    """The virtual joints that carry the base: two slides and a hinge."""

    x: str
    """Slides along the map's x."""
    y: str
    """Slides along the map's y."""
    yaw: str
    """Turns about z."""


class PlanarDrive(Part):
    """A base on virtual joints, driven by velocity."""

    joints: BaseJoints
    """The joints that carry it."""
    force: Force
    """Greatest force of its wheels, N."""
    torque: Strength
    """Greatest torque of its wheels, Nm."""


class JointGains(Part):
    """Gains of a joint's position drive; default: the simulator's usual value."""

    stiffness: Gain | None = None
    """Nm/rad or N/m."""
    damping: Gain | None = None
    """Nm s/rad or N s/m."""
    force: Strength | None = None
    """Greatest torque or force, Nm or N; not given: the URDF's effort limit."""
    armature: Gain = 0.0
    """Inertia of the geared motor as the joint feels it, kg m2 or kg."""


class Linkage(Part):
    """A finger joint without a motor of its own.

    Another joint's motor moves it: when that joint is stopped, this joint takes the rest of the
    motor's travel, as in hands whose fingers wrap around what they grasp.
    """

    motor: str
    """The finger joint whose motor moves it."""
    ratio: Strength
    """Its turn per travel of the motor, for travel that the other joint does not take."""
    share: Strength
    """Its torque, as a share of the other joint's."""
    preload: Annotated[Angle, Field(ge=0)] = 0.0
    """Travel of the motor that its spring holds before it gives way."""


class Cuts(Part):
    """The planes across x, y and z of its own frame at which a mesh is cut, m."""

    x: tuple[Length, ...] = ()
    """Planes across x."""
    y: tuple[Length, ...] = ()
    """Planes across y."""
    z: tuple[Length, ...] = ()
    """Planes across z."""


class Contacts(Part):
    """Which links touch what, and their friction."""

    floor_links: tuple[str, ...] = ()
    """Links that are not checked against the floor: the base and its wheels."""
    no_collision_links: tuple[str, ...] = ()
    """Links that nothing touches."""
    finger_links: tuple[str, ...]
    """Links that hold what is grasped."""
    finger_friction: Annotated[float, Field(gt=0, le=2)]
    """Friction of the pads."""
    convex_cells: dict[str, Cuts] = {}
    """Links whose collision mesh is cut, each cell a convex hull; others are one hull."""
    ignored_collisions: tuple[tuple[str, str], ...] = ()
    """Pairs of links that only a simulator ignores: it takes links for hulls, which may meet where
    the links do not."""
    linkages: dict[str, Linkage] = {}
    """Finger joints that another finger joint's motor moves too."""


class SimulationModel(Contacts):
    """All that a simulator must know of a robot beyond its description."""

    base: PlanarDrive
    """How the base is carried and driven."""
    drives: dict[str, JointGains] = {}
    """Gains by joint."""
    urdf: Path | None = None
    """The robot as built, if a calibration says that it is elsewhere; None: as described."""
