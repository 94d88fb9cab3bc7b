"""Constants and tunables of the simulation, each with its unit and reason."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_bt.world import TICK

SUB_STEPS = 12
"""Physics steps in a tick: 1/240 s each holds a friction grasp and runs 30 times real time."""
STEP = TICK / SUB_STEPS
"""Seconds of one physics step."""


@dataclass(frozen=True)
class Physics:
    """PhysX settings. Iterations and contact offset are the least that hold a can without creep."""

    position_iterations: int = 15
    velocity_iterations: int = 1
    contact_offset: float = 0.005
    """m; half the default of 0.02 and less, or resting things report contacts at a distance."""
    persistent_contacts: bool = False
    """Whether contact points are kept from step to step. Kept ones give energy to what rocks on its
    edge: a bottle that is let go leaning by two degrees then rocks until it falls."""
    arm_stiffness: float = 1e4
    arm_damping: float = 1e3
    """Nm/rad and Nm s/rad (N/m, N s/m for the torso): below 1 mrad of lag, well damped."""
    base_damping: float = 1e5
    """N s/m; stiff enough that the force limit, not the gain, decides what a bump feels like."""
    finger_stiffness: float = 1e4
    finger_damping: float = 2e2
    """N/m, N s/m; the force limit is reached with 6 mm of the target still to go at 60 N."""
    tendon_stiffness: float = 1e5
    tendon_damping: float = 1e3
    """N/m, N s/m of the coupling that keeps both fingers equally far open."""


@dataclass(frozen=True)
class JointErrors:
    """Errors of joint measurement; 1-sigma."""

    offset: float = 1e-3
    """rad; constant for an episode, what is left after calibrating a real arm."""
    offset_prismatic: float = 5e-4
    """m; the same for the torso."""
    noise: float = 1e-4
    """rad or m; encoder noise of one reading."""
    velocity_noise: float = 2e-3
    """rad/s or m/s."""
    effort_noise: float = 0.3
    """Nm or N."""
    width_bias: float = 5e-4
    """m; of the gripper width, constant for an episode."""
    width_noise: float = 3e-4
    """m; of one reading; with the bias nearly always within 1 mm."""
    grip_noise: float = 1.0
    """N; of the gripper's effort."""


@dataclass(frozen=True)
class OdometryErrors:
    """Wheel odometry: scale errors constant for an episode, and a random walk; 1-sigma."""

    linear_scale: float = 0.008
    """relative; tyre radius."""
    angular_scale: float = 0.015
    """relative; wheel base."""
    yaw_per_metre: float = 0.006
    """rad per sqrt(m) driven."""
    yaw_per_turn: float = 0.012
    """rad per sqrt(rad) turned."""
    slip: float = 0.005
    """m per sqrt(m) driven."""
    speed_noise: float = 0.005
    """m/s and rad/s of the reported speeds."""


@dataclass(frozen=True)
class CameraErrors:
    """Errors of the RGB-D camera; 1-sigma."""

    mounting_position: float = 0.0017
    """m per axis: 3 mm in all."""
    mounting_angle: float = 0.003
    """rad per axis: 0.3 degrees in all."""
    depth_noise: float = 0.0015
    """1/m; sigma of depth z is this times z squared, as of structured light."""
    depth_quantum: float = 0.001
    """m; depth comes in whole millimetres."""
    edge_jump: float = 0.04
    """m per m of depth; where neighbours differ by more the projected pattern is torn: a hole."""
    edge_hole: float = 0.7
    """share of the pixels at such an edge that are lost."""
    drop_out: float = 0.002
    """share of all other pixels that are lost."""
    color_noise: float = 2.0
    """grey levels of 255."""


@dataclass(frozen=True)
class LaserErrors:
    """Errors of the laser; 1-sigma."""

    range_noise: float = 0.012
    """m."""
    drop_out: float = 0.002
    """share of beams that return nothing."""


@dataclass(frozen=True)
class LidarErrors:
    """Errors of a lidar; 1-sigma."""

    range_noise: float = 0.01
    """m; makers' "3 cm" is three of them."""
    drop_out: float = 0.005
    """share of rays that return nothing: dark and shiny things."""


@dataclass(frozen=True)
class WrenchErrors:
    """Errors of the wrist's force and torque; 1-sigma."""

    force_bias: float = 0.6
    """N per axis, constant for an episode."""
    force_noise: float = 0.25
    """N."""
    torque_bias: float = 0.06
    """Nm per axis, constant for an episode."""
    torque_noise: float = 0.02
    """Nm."""


@dataclass(frozen=True)
class SimulatorConfig:
    """Everything that can be tuned about a simulation."""

    physics: Physics = field(default_factory=Physics)
    joints: JointErrors = field(default_factory=JointErrors)
    odometry: OdometryErrors = field(default_factory=OdometryErrors)
    camera: CameraErrors = field(default_factory=CameraErrors)
    laser: LaserErrors = field(default_factory=LaserErrors)
    lidar: LidarErrors = field(default_factory=LidarErrors)
    wrench: WrenchErrors = field(default_factory=WrenchErrors)
