"""Jogging the arm: the hand along an axis, or joint by joint, stopping before it touches."""

from __future__ import annotations

from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.lazy import lazily
from momantu_bt.messages import RobotState
from momantu_bt.robot import ARM, Robot
from momantu_bt.teleoperation import STANDING, Command
from momantu_skills.manipulation.motion.setpoint import Setpoint
from momantu_skills.manipulation.scene.arm_scene import ArmScene

with lazily():
    from momantu_skills.manipulation.model import collision

MARGIN = 0.01
"""Clearance at which the arm stops before what it would touch, m: the joints lag behind the
setpoint by fractions of a second, each by its own."""
AT_LIMIT = 2e-3
"""Distance from a limit at which a joint is named as the reason, rad or m."""
REFRESH = 1.0
"""Time after which the site's surfaces are placed anew, as localization knows them, s."""
COARSE = (0.005, 0.01)
"""Changes of the base's pose and of other joints that do not call for a new collision world, m or
rad."""


class Jog:
    """Moves the arm's setpoint by commands, as far as limits and collisions allow."""

    def __init__(self, robot: Robot, service: ArmScene) -> None:
        self._robot, self._service = robot, service
        self._scene = service.scene
        self._model = service.scene.model
        self.setpoint = Setpoint(robot, ARM)
        self._hand: Transform | None = None
        self._worlds: dict[float, collision.CollisionWorld] = {}
        self._situation: Any = None
        self._placed = -np.inf

    def advance(self, command: Command, now: float, seconds: float) -> str:
        """Move on by `seconds`, and say what the arm does, in a phase."""
        if command.stop:
            self.setpoint.drop()
            self._hand = None
        speeds = {n: v for n, v in command.joints.items() if n in self.setpoint.names and v}
        late = self.setpoint.held_back()
        if late is not None:
            self._hand = None
            return f"stopped: {late} does not follow"
        if command.hand == STANDING and not speeds:
            self._hand = None
            self.setpoint.command()
            return "standing"
        start = self.setpoint.begin()
        if speeds:
            self._hand = None
            joints, limit = self.setpoint.stepped(speeds, seconds)
            why = None if limit is None else f"{limit} is at its limit"
        else:
            joints, why = self._hand_moved(start, command, seconds)
        why = why or self._touched(start, joints, now)
        if why is not None:
            self._hand = None
            self.setpoint.command()
            return f"stopped: {why}"
        self.setpoint.move(joints, seconds)
        return "moving a joint" if speeds else "moving the hand"

    def _hand_moved(
        self, start: Array, command: Command, seconds: float
    ) -> tuple[Array, str | None]:
        """Joints (n,) after the hand's next step; or the start, and why it cannot make it."""
        group, grasp = self._model.group, self._model.tip_from_grasp
        before = self._hand or group.tip_pose(start) @ grasp
        after = _moved(before, command, seconds)
        path, reached = group.trace((after @ grasp.inverse()).matrix[None], start)
        if not reached:
            return start, self._end_of_reach(start)
        change = np.abs(path[0] - start) / (self.setpoint.velocity * seconds)
        share = 1.0 / max(1.0, float(change.max()))
        joints = np.asarray(start + share * (path[0] - start))
        self._hand = after if share == 1.0 else group.tip_pose(joints) @ grasp
        return joints, None

    def _end_of_reach(self, joints: Array) -> str:
        """Why the hand cannot go on from here."""
        setpoint = self.setpoint
        near = np.minimum(joints - setpoint.lower, setpoint.upper - joints) < AT_LIMIT
        names = [name for name, at in zip(setpoint.names, near, strict=True) if at]
        if names:
            return f"the hand cannot go on there, {' and '.join(names)} at the limit"
        return "the hand cannot go on there, the arm is stretched or folded as far as it goes"

    def _touched(self, start: Array, joints: Array, now: float) -> str | None:
        """What the arm would touch at joints (n,); it may leave what it is too near to already."""
        self._look_again(self._robot.state(), now)
        if self._world(MARGIN).free(joints):
            return None
        if self._world(MARGIN).free(start):
            return _words(*self._world(MARGIN).touching(joints)[0])
        before = set(self._world(0.0).touching(start))
        new = [pair for pair in self._world(0.0).touching(joints) if pair not in before]
        return _words(*new[0]) if new else None

    def _world(self, margin: float) -> collision.CollisionWorld:
        if margin not in self._worlds:
            state, held = self._robot.state(), self._service.held
            self._worlds[margin] = self._scene.world(state, held, margin)
        return self._worlds[margin]

    def _look_again(self, state: RobotState, now: float) -> None:
        """Forget the collision worlds where anything but the arm has changed."""
        if now - self._placed >= REFRESH:
            self._service.take_over_site()
            self._placed = now
            self._worlds.clear()
        odom, own = state.odom_from_base, set(self.setpoint.names)
        others = [p for name, p in state.joints().items() if name not in own]
        coarse = np.concatenate([odom.position / COARSE[0], odom.quaternion / COARSE[1]])
        others = [round(p / COARSE[1]) for p in [*others, state.gripper_width]]
        held = self._service.held
        situation = (*np.round(coarse).tolist(), *others, id(held), id(self._scene.surroundings))
        if situation != self._situation:
            self._situation = situation
            self._worlds.clear()


def _moved(hand: Transform, command: Command, seconds: float) -> Transform:
    """base_from_grasp after a step of the commanded twist: shifted, and turned about itself."""
    twist = np.array(command.hand) * seconds
    turned, angle = hand.quaternion, float(np.linalg.norm(twist[3:]))
    if angle > 0.0:
        turn = Transform((0.0, 0.0, 0.0), quaternion_from_axis_angle(twist[3:], angle))
        turned = (turn @ Transform((0.0, 0.0, 0.0), turned)).quaternion
    return Transform(hand.position + twist[:3], turned)


def _words(one: str, other: str) -> str:
    """`elbow_link would touch a surface`."""
    names = [name.partition(":")[0] for name in (one, other)]
    shown = ["a surface" if name.startswith("support ") else name for name in names]
    return f"{shown[0]} would touch {shown[1]}"
