"""A small robot of a few joints, for tests that need any robot."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.robot import (
    Actuator,
    ActuatorKind,
    BaseLimits,
    CameraSensor,
    EndEffector,
    JointLimit,
    LaserSensor,
    PlanningGroup,
    RobotDescription,
    Sensor,
    Working,
    WristWrench,
)

URDF = Path(__file__).parent / "small_robot.urdf"
_ARM = ("lift", "shoulder", "elbow")
_HEAD = ("pan", "tilt")
_LIMITS = {
    "lift": JointLimit(lower=0.0, upper=0.4, velocity=0.1, acceleration=0.3),
    "shoulder": JointLimit(lower=-1.6, upper=1.6, velocity=1.2, acceleration=1.5),
    "elbow": JointLimit(lower=-2.2, upper=2.2, velocity=1.5, acceleration=1.5),
    "pan": JointLimit(lower=-1.5, upper=1.5, velocity=1.5, acceleration=3.0),
    "tilt": JointLimit(lower=-0.7, upper=1.4, velocity=1.5, acceleration=3.0),
}
_SENSORS: dict[str, Sensor] = {
    "camera": CameraSensor(
        frame="camera_optical_frame",
        carrier="head",
        width=64,
        height=48,
        horizontal_fov=1.05,
        min_depth=0.35,
        max_depth=4.5,
    ),
    "laser": LaserSensor(
        frame="laser_link",
        angle_min=-1.9,
        angle_max=1.9,
        beams=181,
        range_min=0.05,
        range_max=25.0,
    ),
    "wrench": WristWrench(frame="gripper_link"),
}
_HAND = EndEffector(
    frame="gripper_link",
    max_width=0.1,
    max_force=60.0,
    pad_length=0.06,
    pad_height=0.02,
    hand_clearance=0.04,
    touch_links=("gripper_link",),
)


def small_robot() -> RobotDescription:
    """A base, a lift with a two-joint arm, a pan-tilt head with a camera, a laser, a wrench."""
    return RobotDescription(
        name="small",
        urdf=URDF,
        height=1.2,
        working=Working(stand_off=0.4, look_off=0.6, reach=(0.4, 0.6, 0.8)),
        footprint=((0.25, 0.2), (-0.25, 0.2), (-0.25, -0.2), (0.25, -0.2)),
        base=BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0),
        actuators={
            "base": Actuator(kind=ActuatorKind.BASE),
            "arm": Actuator(kind=ActuatorKind.JOINTS, joints=_ARM),
            "head": Actuator(kind=ActuatorKind.JOINTS, joints=_HEAD),
            "gripper": Actuator(kind=ActuatorKind.GRIPPER),
        },
        joint_limits=_LIMITS,
        sensors=_SENSORS,
        groups={"arm": PlanningGroup(joints=_ARM, tip="gripper_link")},
        end_effector=_HAND,
        named_poses={
            name: {"lift": lift, "shoulder": turn, "elbow": -turn}
            for name, lift, turn in (
                ("home", 0.0, 1.3),
                ("ready", 0.2, 0.5),
                ("carry", 0.1, 1.2),
                ("look_around", 0.1, 1.0),
            )
        },
    )


def armless_robot() -> RobotDescription:
    """The small robot with its head and its sensors, and without its arm, hand and named poses."""
    whole = small_robot()
    gone = {"arm", "gripper"}
    return RobotDescription(
        **{
            **dict(whole),
            "name": "armless",
            "working": Working(stand_off=0.4, look_off=0.6),
            "actuators": {n: a for n, a in whole.actuators.items() if n not in gone},
            "joint_limits": {n: limit for n, limit in whole.joint_limits.items() if n in _HEAD},
            "sensors": {n: s for n, s in whole.sensors.items() if s.kind != "wrench"},
            "groups": {},
            "end_effector": None,
            "named_poses": {},
        }
    )
