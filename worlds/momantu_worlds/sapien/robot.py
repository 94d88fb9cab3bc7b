"""The simulated robot's driver, with the same interface as a real robot's driver."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.messages import ActuatorGoal, RobotState, frozen
from momantu_bt.robot import (
    Actuator,
    ActuatorKind,
    EndEffector,
    RobotDescription,
    SensorReading,
    SimulationModel,
)
from momantu_worlds.sapien.build.robot_model import RobotModel
from momantu_worlds.sapien.config import SimulatorConfig
from momantu_worlds.sapien.drives.base import BaseDrive
from momantu_worlds.sapien.drives.fingers import Hanging, Tips
from momantu_worlds.sapien.drives.followers import Followers
from momantu_worlds.sapien.drives.fresh_contacts import FreshContacts
from momantu_worlds.sapien.drives.gripper import GripperDrive
from momantu_worlds.sapien.drives.joints import JointDrive
from momantu_worlds.sapien.drives.proprioception import Encoders, Odometry, prismatic_joints


class Sensor(Protocol):
    """A sensor that can be read at the current time."""

    def read(self, stamp: float) -> SensorReading:
        """Read the sensor at `stamp`, the current time."""
        ...


class SimulatedRobot:
    """Implements `momantu_bt.robot.Robot`.

    sensors: by the description's names; read at most once per instant.
    listeners: called once for each reading that the robot itself asks for.
    """

    def __init__(
        self,
        description: RobotDescription,
        simulation: SimulationModel,
        model: RobotModel,
        start: Pose2D,
        pose: Mapping[str, float],
        seed: int,
        config: SimulatorConfig,
        now: Callable[[], float],
    ) -> None:
        self._description, self._model, self._now = description, model, now
        self.sensors: dict[str, Sensor] = {}
        self._readings: dict[str, SensorReading] = {}
        self._asked: dict[str, float] = {}
        self.listeners: list[Callable[[SensorReading], None]] = []
        self._state: RobotState | None = None
        self._names = tuple(
            name
            for actuator in description.actuators.values()
            if actuator.kind is ActuatorKind.JOINTS
            for name in actuator.joints
        )
        self._columns = [model.index[name] for name in self._names]
        hand = description.end_effector
        self._fingers = {name: model.index[name] for name in (hand.opening if hand else ())}
        prismatic = prismatic_joints(description, self._names)
        self._encoders = Encoders(self._names, prismatic, seed, config.joints)
        self._odometry = Odometry(start, seed, config.odometry)
        base = simulation.base.joints
        self._base_columns = [model.index[n] for n in (base.x, base.y, base.yaw)]
        gains = [model.gains[name] for name in self._names]
        self._stiffness = np.array([each.stiffness for each in gains])
        self._damping = np.array([each.damping for each in gains])
        self._efforts = np.array([each.force for each in gains])
        slides = model.joints[base.x], model.joints[base.y]
        self.base = BaseDrive(*slides, model.joints[base.yaw], description.base)
        self.joint_drives = {
            name: self._joint_drive(actuator)
            for name, actuator in description.actuators.items()
            if actuator.kind is ActuatorKind.JOINTS
        }
        self._driven = [
            (drive, [model.index[name] for name in drive.names])
            for drive in self.joint_drives.values()
        ]
        self.gripper = None if hand is None else self._gripper_drive(simulation, hand)
        held_by = () if hand is None else hand.touch_links
        self._hand_contacts = FreshContacts(model.links[name] for name in held_by)
        self._followers = Followers(model.mimics.values())
        self._place(start, pose)

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self._description

    def state(self) -> RobotState:
        """Current joints and odometry, as measured."""
        stamp = self._now()
        if self._state is None or self._state.stamp != stamp:
            self._state = self._measure(stamp)
        return self._state

    def read(self, sensor: str) -> SensorReading:
        """Read a sensor now; KeyError lists the sensors if there is none of that name."""
        reading = self.peek(sensor)
        if self._asked.get(sensor) != reading.stamp:
            self._asked[sensor] = reading.stamp
            for listener in self.listeners:
                listener(reading)
        return reading

    def peek(self, sensor: str) -> SensorReading:
        """Like `read`, for videos: it does not count as a reading by the robot."""
        if sensor not in self.sensors:
            names = ", ".join(self.sensors)
            raise KeyError(f"the robot has no sensor {sensor!r}; it has: {names}")
        stamp = self._now()
        known = self._readings.get(sensor)
        if known is None or known.stamp != stamp:
            known = self._readings[sensor] = self.sensors[sensor].read(stamp)
        return known

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Send a goal to an actuator; see `momantu_bt.robot.Robot.command`."""
        kind = self._actuator(actuator).kind
        if kind is ActuatorKind.BASE:
            self.base.command(goal, self._now())
        elif kind is ActuatorKind.JOINTS:
            self.joint_drives[actuator].command(goal, self._now())
        elif self.gripper is not None and actuator == self._description.hand.actuator:
            self.gripper.command(goal)
        else:
            raise ValueError(f"{actuator} is not the end effector's gripper: nothing moves it")

    def stop(self, actuator: str) -> None:
        """Brake at the limits; the gripper keeps its last force."""
        kind = self._actuator(actuator).kind
        if kind is ActuatorKind.BASE:
            self.base.stop()
        elif kind is ActuatorKind.JOINTS:
            self.joint_drives[actuator].stop()

    def carry(self, map_from_base: Pose2D) -> None:
        """Set the base down elsewhere, at rest; joints keep their angles, odometry its pose."""
        positions, speeds = self._model.positions(), self._model.velocities()
        positions[self._base_columns] = (map_from_base.x, map_from_base.y, map_from_base.yaw)
        speeds[self._base_columns] = 0.0
        self._model.articulation.set_qpos(positions.astype(np.float32))
        self._model.articulation.set_qvel(speeds.astype(np.float32))
        self.base.place()
        self._odometry.carried(self._true_base(self._model.positions()))

    def begin_tick(self) -> None:
        """Prepare the drives for the physics steps of the coming tick."""
        now = self._now()
        self.base.begin_tick(now)
        true = self._model.positions()
        for drive, columns in self._driven:
            drive.begin_tick(now, true[columns])

    def apply(self, index: int) -> None:
        """Set every drive's target for physics step `index` of this tick."""
        positions = self._model.articulation.get_qpos()
        self.base.apply(float(positions[self._base_columns[2]]))
        for drive in self.joint_drives.values():
            drive.apply(index)
        if self.gripper is not None:
            self.gripper.apply(positions)
        self._followers.follow(positions)
        self._hand_contacts.refresh()

    def end_tick(self) -> None:
        """Update odometry with the tick's motion; the clock shows the end of the tick already."""
        self._odometry.update(self._true_base(self._model.positions()), self._now())

    def _actuator(self, name: str) -> Actuator:
        actuators = self._description.actuators
        if name not in actuators:
            raise KeyError(f"the robot has no actuator {name!r}; it has: {', '.join(actuators)}")
        return actuators[name]

    def _measure(self, stamp: float) -> RobotState:
        true, speeds = self._model.positions(), self._model.velocities()
        positions, velocities, efforts = self._encoders.joints(
            true[self._columns], speeds[self._columns], self._drive_efforts(true, speeds), stamp
        )
        width, grip = self._measure_gripper(true, stamp)
        base = self._true_base(true)
        vx, vy, wz = (float(speeds[i]) for i in self._base_columns)
        forward = vx * np.cos(base.yaw) + vy * np.sin(base.yaw)
        linear, angular = self._odometry.speeds(float(forward), wz, stamp)
        lateral = 0.0
        if self._description.base.sideways:
            lateral = float(vy * np.cos(base.yaw) - vx * np.sin(base.yaw))
            lateral = self._odometry.sideways(lateral, stamp)
        return RobotState(
            stamp,
            self._names,
            np.asarray(frozen(positions)),
            np.asarray(frozen(velocities)),
            np.asarray(frozen(efforts)),
            self._odometry.odom_from_base.transform(),
            linear,
            angular,
            width,
            grip,
            lateral,
        )

    def _measure_gripper(self, true: Array, stamp: float) -> tuple[float, float]:
        """Opening, m, and closing force, N, as measured; none of either without a hand."""
        if self.gripper is None:
            return 0.0, 0.0
        fingers = {name: float(true[i]) for name, i in self._fingers.items()}
        opening = self._description.hand.width(fingers)
        return self._encoders.gripper(opening, self.gripper.effort(fingers), stamp)

    def _drive_efforts(self, true: Array, speeds: Array) -> Array:
        """Force of the drives, Nm or N: their control law, within the effort limits."""
        drives = self.joint_drives.values()
        if not drives:
            return np.zeros(0)
        target = np.concatenate([d.position for d in drives])
        speed = np.concatenate([d.velocity for d in drives])
        push = self._stiffness * (target - true[self._columns])
        push += self._damping * (speed - speeds[self._columns])
        return np.clip(push, -self._efforts, self._efforts)

    def _true_base(self, positions: Array) -> Pose2D:
        x, y, yaw = (float(positions[i]) for i in self._base_columns)
        return Pose2D(x, y, yaw)

    def _joint_drive(self, actuator: Actuator) -> JointDrive:
        places = [self._names.index(name) for name in actuator.joints]
        return JointDrive(
            actuator.joints,
            [self._model.joints[name] for name in actuator.joints],
            [self._description.joint_limits[name] for name in actuator.joints],
            self._encoders.offsets[places],
            self._efforts[places],
            self._stiffness[places],
        )

    def _gripper_drive(self, simulation: SimulationModel, effector: EndEffector) -> GripperDrive:
        model = self._model
        limits = self._description.joint_limits
        tips = Tips(simulation.linkages, model.fingers, model.joints, model.gains, model.index)
        speeds = {name: limits[name].velocity for name in effector.opening}
        hanging = Hanging(effector, model.fingers, model.index)
        return GripperDrive(model.fingers, tips, hanging, effector, speeds)

    def _place(self, start: Pose2D, pose: Mapping[str, float]) -> None:
        """Stand at `start` with the joints at `pose` and any gripper open, at rest."""
        positions = self._model.positions()
        positions[self._base_columns] = (start.x, start.y, start.yaw)
        for name, value in pose.items():
            positions[self._model.index[name]] = value
        for name, follower in self._model.mimics.items():
            positions[self._model.index[name]] = follower.where(positions)
        effector = self._description.end_effector
        opened = {} if effector is None else effector.positions(effector.max_width)
        for name, value in opened.items():
            positions[self._fingers[name]] = value
        self._model.articulation.set_qpos(positions.astype(np.float32))
        self._model.articulation.set_qvel(np.zeros(len(positions), dtype=np.float32))
        for drive in self.joint_drives.values():
            drive.place(np.array([positions[self._model.index[n]] for n in drive.names]))
        for name in self._model.idle:
            self._model.joints[name].set_drive_target(positions[self._model.index[name]])
        if self.gripper is not None and effector is not None:
            self.gripper.place(effector.max_width)
