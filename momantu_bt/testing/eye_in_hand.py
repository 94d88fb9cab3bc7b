"""A robot with its camera on the hand, for tests of skills that must not rely on a head."""

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
    Working,
)

URDF = Path(__file__).parent / "eye_in_hand.urdf"
_ARM = ("turn", "shoulder", "elbow", "roll", "bend", "twist")
_FINGERS = ("left_slide", "right_slide")
_POSES = {
    # joint values of each pose, in order; the camera looks ahead and down, in "carry" horizontally
    "home": (0.01, 4.08, 0.66, 0.23, 1.11, 2.33),
    "ready": (-0.05, 4.28, 5.44, 0.02, -1.23, -2.55),
    "carry": (-0.38, 3.19, 0.46, -2.71, -2.31, 0.54),
    "look_around": (0.42, 3.34, 3.09, 0.76, 3.08, -2.0),
}


def eye_in_hand_robot() -> RobotDescription:
    """A box with a slow six-joint arm, a camera above its two fingers, a laser; no head."""
    slow = JointLimit(velocity=0.63, acceleration=1.0)
    wrist = JointLimit(velocity=0.84, acceleration=1.5)
    finger = JointLimit(lower=0.0, upper=0.06, velocity=0.05, acceleration=0.5)
    return RobotDescription(
        name="eye_in_hand",
        urdf=URDF,
        footprint=((0.27, 0.23), (-0.27, 0.23), (-0.27, -0.23), (0.27, -0.23)),
        height=1.4,
        working=Working(stand_off=0.35, look_off=0.45, reach=(0.40, 0.55, 0.75)),
        base=BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=2.5),
        actuators={
            "base": Actuator(kind=ActuatorKind.BASE),
            "arm": Actuator(kind=ActuatorKind.JOINTS, joints=_ARM),
            "gripper": Actuator(kind=ActuatorKind.GRIPPER, joints=_FINGERS),
        },
        joint_limits={
            "turn": slow,
            "shoulder": slow.model_copy(update={"lower": 0.82, "upper": 5.46}),
            "elbow": slow.model_copy(update={"lower": 0.33, "upper": 5.95}),
            "roll": wrist,
            "bend": wrist,
            "twist": wrist,
            "left_slide": finger,
            "right_slide": finger,
        },
        sensors={
            "camera": CameraSensor(
                frame="camera_optical",
                carrier="arm",
                horizontal_fov=1.2,
                min_depth=0.2,
                max_depth=5.0,
            ),
            "laser": LaserSensor(
                frame="laser_link",
                angle_min=-1.9,
                angle_max=1.9,
                beams=181,
                range_min=0.05,
                range_max=25.0,
            ),
        },
        groups={"arm": PlanningGroup(joints=_ARM, tip="palm")},
        end_effector=EndEffector(
            frame="hand",
            max_width=0.12,
            max_force=40.0,
            pad_length=0.08,
            pad_height=0.02,
            hand_clearance=0.05,
            touch_links=("palm", "left_finger", "right_finger"),
        ),
        named_poses={name: dict(zip(_ARM, values, strict=True)) for name, values in _POSES.items()},
    )
