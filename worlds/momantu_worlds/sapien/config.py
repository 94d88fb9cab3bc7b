"""Constants and tunables of the simulation, each with its unit and the reason for its value."""

from __future__ import annotations

from dataclasses import dataclass, field

from momantu_bt.world import TICK

SUB_STEPS = 12
"""Physics steps per tick: 1/240 s each keeps a friction grasp stable and runs 30 times real
time."""
STEP = TICK / SUB_STEPS
"""Duration of one physics step, s."""


@dataclass(frozen=True)
class Physics:
    """PhysX settings. Iterations and contact offset: the least that hold a can without creep."""

    position_iterations: int = 15
    velocity_iterations: int = 1
    contact_offset: float = 0.005
    """Distance at which contacts are generated, m; it must be at most half of the default of 0.02,
    or resting bodies report contacts at a distance."""
    persistent_contacts: bool = False
    """Whether contact points are kept from step to step. If they are kept, a body that rocks on its
    edge gains energy: a bottle that is released at a tilt of two degrees then rocks until it
    falls."""
    arm_stiffness: float = 1e4
    arm_damping: float = 1e3
    """Stiffness and damping, Nm/rad and Nm s/rad (N/m, N s/m for the torso): less than 1 mrad of
    lag, well damped."""
    base_damping: float = 1e5
    """Damping of the base's drive, N s/m: high, so that the force limit, not the gain, determines
    the force of a bump."""
    finger_stiffness: float = 1e4
    finger_damping: float = 2e2
    """Stiffness and damping of the fingers, N/m, N s/m; at 60 N the force limit is reached 6 mm
    before the target."""
    finger_rotor: float = 0.75
    """Inertia of the motor of a finger that turns, as mass at the pads, kg, where the robot's
    description gives none."""
    tendon_stiffness: float = 1e5
    tendon_damping: float = 1e3
    """Stiffness and damping of the coupling that keeps both fingers equally far open, N/m, N
    s/m."""


@dataclass(frozen=True)
class JointErrors:
    """Errors of joint measurement; 1-sigma."""

    offset: float = 1e-3
    """Constant offset in an episode, rad: what is left after calibrating a real arm."""
    offset_prismatic: float = 5e-4
    """The same for the torso, m."""
    noise: float = 1e-4
    """Encoder noise of one reading, rad or m."""
    velocity_noise: float = 2e-3
    """Noise of velocities, rad/s or m/s."""
    effort_noise: float = 0.3
    """Noise of efforts, Nm or N."""
    width_bias: float = 5e-4
    """Bias of the gripper width, m, constant in an episode."""
    width_noise: float = 3e-4
    """Noise of one width reading, m; with the bias nearly always within 1 mm."""
    grip_noise: float = 1.0
    """Noise of the gripper's effort, N."""


@dataclass(frozen=True)
class OdometryErrors:
    """Wheel odometry: scale errors that are constant in an episode, and a random walk; 1-sigma."""

    linear_scale: float = 0.008
    """Relative scale error of distances: tyre radius."""
    angular_scale: float = 0.015
    """Relative scale error of turns: wheel base."""
    yaw_per_metre: float = 0.006
    """Heading error, rad per sqrt(m) driven."""
    yaw_per_turn: float = 0.012
    """Heading error, rad per sqrt(rad) turned."""
    slip: float = 0.005
    """Position error, m per sqrt(m) driven."""
    speed_noise: float = 0.005
    """Noise of the reported speeds, m/s and rad/s."""


@dataclass(frozen=True)
class CameraErrors:
    """Errors of the RGB-D camera; 1-sigma."""

    mounting_position: float = 0.0017
    """Position error of the mounting, m per axis: 3 mm in all."""
    mounting_angle: float = 0.003
    """Angle error of the mounting, rad per axis: 0.3 degrees in all."""
    depth_noise: float = 0.0015
    """The sigma of depth z is this times z squared, 1/m, as for structured light."""
    depth_quantum: float = 0.001
    """Step of depth values, m: whole millimetres."""
    edge_jump: float = 0.04
    """Depth difference of neighbouring pixels, m per m of depth, above which the projected pattern
    is broken and pixels are lost."""
    edge_hole: float = 0.7
    """Share of the pixels at such an edge that are lost."""
    drop_out: float = 0.002
    """Share of all other pixels that are lost."""
    color_noise: float = 2.0
    """Noise of colours, grey levels of 255."""


@dataclass(frozen=True)
class LaserErrors:
    """Errors of the laser; 1-sigma."""

    range_noise: float = 0.012
    """Noise of ranges, m."""
    drop_out: float = 0.002
    """Share of beams without a return."""


@dataclass(frozen=True)
class LidarErrors:
    """Errors of a lidar; 1-sigma."""

    range_noise: float = 0.01
    """Noise of ranges, m; manufacturers' "3 cm" is three sigma."""
    drop_out: float = 0.005
    """Share of rays without a return: dark and shiny surfaces."""


@dataclass(frozen=True)
class ImuErrors:
    """Errors of an IMU as small robots carry it; 1-sigma. Densities are those of one axis."""

    rate_bias: float = 0.003
    """Bias of turning speeds, rad/s per axis, constant in an episode."""
    rate_noise: float = 1.5e-4
    """Density of their noise, rad/s per sqrt(Hz)."""
    force_bias: float = 0.05
    """Bias of specific forces, m/s2 per axis, constant in an episode."""
    force_noise: float = 2e-3
    """Density of their noise, m/s2 per sqrt(Hz)."""


@dataclass(frozen=True)
class WrenchErrors:
    """Errors of the wrist's force and torque; 1-sigma."""

    force_bias: float = 0.6
    """Bias of the force, N per axis, constant in an episode."""
    force_noise: float = 0.25
    """Noise of the force, N."""
    torque_bias: float = 0.06
    """Bias of the torque, Nm per axis, constant in an episode."""
    torque_noise: float = 0.02
    """Noise of the torque, Nm."""


@dataclass(frozen=True)
class SimulatorConfig:
    """All tunables of a simulation."""

    physics: Physics = field(default_factory=Physics)
    joints: JointErrors = field(default_factory=JointErrors)
    odometry: OdometryErrors = field(default_factory=OdometryErrors)
    camera: CameraErrors = field(default_factory=CameraErrors)
    laser: LaserErrors = field(default_factory=LaserErrors)
    lidar: LidarErrors = field(default_factory=LidarErrors)
    imu: ImuErrors = field(default_factory=ImuErrors)
    wrench: WrenchErrors = field(default_factory=WrenchErrors)
