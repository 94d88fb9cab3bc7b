"""What pressed keys mean: speeds that last for a moment, their limits, and the arm's mode."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any

from momantu_bt.cli.teleop.abilities import Abilities
from momantu_bt.teleoperation import DEAD_MAN, Command, Twist

HELD = 0.25
"""Time that a key which the keyboard repeats has an effect, s: some repetitions."""
GAP = 0.2
"""Longest time between two repetitions of a key that is held, s."""
FASTER = 1.25
"""Factor of one key press that changes a speed."""
LEAST = 0.05
"""Least share of the greatest speed."""
FIRST = 0.3
"""Share of the greatest speed at the start."""
HAND = (0.3, 1.0)
"""Greatest speeds of the hand, m/s and rad/s; the limits of the joints hold as well."""
CURVE = 0.5
"""Share of the turning speed with which curves are driven."""
HEAD = 0.4
"""Share of the head's greatest speed."""
_DRIVE: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        **dict.fromkeys(("w", "up"), (1.0, 0.0)),
        **dict.fromkeys(("s", "down"), (-1.0, 0.0)),
        **dict.fromkeys(("a", "left"), (0.0, 1.0)),
        **dict.fromkeys(("d", "right"), (0.0, -1.0)),
        "q": (1.0, CURVE),
        "e": (1.0, -CURVE),
    }
)
"""Shares of the base's speeds ahead and to the left, by key."""
_SLIDE: Mapping[str, float] = MappingProxyType({"[": 1.0, "]": -1.0})
"""Shares of an omnidirectional base's speed sideways, by key."""
_HAND: Mapping[str, tuple[int, float]] = MappingProxyType(
    {
        "i": (0, 1.0),
        "k": (0, -1.0),
        "j": (1, 1.0),
        "l": (1, -1.0),
        "u": (2, 1.0),
        "o": (2, -1.0),
        "U": (3, 1.0),
        "O": (3, -1.0),
        "I": (4, -1.0),
        "K": (4, 1.0),
        "J": (5, 1.0),
        "L": (5, -1.0),
    }
)
"""Axis of the hand's motion in the base frame, and its direction, by key."""


@dataclass(frozen=True, slots=True)
class _Press:
    """A key that has an effect until a time, s. part: of the command."""

    key: str
    at: float
    until: float
    part: Callable[[Command], Command]


class Controls:
    """Keys in, commands out, by the world's clock alone.

    A key has an effect for DEAD_MAN s; a key that the keyboard repeats, for HELD s after its last
    repetition. Base, arm, head and gripper each have one key at a time.

    base_share, arm_share: of the greatest speeds. by_joints: whether the arm moves joint by joint.
    joint: the chosen one. said: the answer to the last key, or "". leaving: the person has left.
    """

    def __init__(self, able: Abilities) -> None:
        self.able = able
        self.base_share = self.arm_share = FIRST
        self.by_joints = False
        self.said = ""
        self.leaving = False
        self._at = 0
        self._stop = False
        self._pressed: dict[str, _Press] = {}
        self._does: dict[str, Callable[[], None]] = {
            **dict.fromkeys((" ", "escape"), self._stop_all),
            **dict.fromkeys(("x", "leave"), self.leave),
        }
        self._moves: dict[str, tuple[str, Callable[[Command], Command]]] = {}
        if able.base is not None:
            self._add_base()
        if able.joints:
            self._add_arm()
        self._add_head()
        if able.opening is not None:
            self._moves["c"] = "gripper", partial(_opened, 0.0)
            self._moves["v"] = "gripper", partial(_opened, able.opening)

    @property
    def joint(self) -> str:
        """The arm's chosen joint."""
        return list(self.able.joints)[self._at]

    @property
    def base_speed(self) -> tuple[float, float]:
        """The base's speeds, m/s and rad/s."""
        base = self.able.base
        return (
            (0.0, 0.0)
            if base is None
            else (
                self.base_share * base.linear,
                self.base_share * base.angular,
            )
        )

    @property
    def hand_speed(self) -> tuple[float, float]:
        """The hand's speeds, m/s and rad/s."""
        return self.arm_share * HAND[0], self.arm_share * HAND[1]

    @property
    def joint_speed(self) -> float:
        """The chosen joint's speed, rad/s or m/s."""
        return self.arm_share * self.able.joints[self.joint]

    def leave(self) -> None:
        """The person leaves: the robot brakes, and the run ends."""
        self.leaving, self.said = True, "leaving: the robot comes to rest"

    def press(self, key: str, now: float) -> None:
        """Handle a key, pressed or repeated at a time of the world's clock, s."""
        self.said = ""
        if key in self._does:
            self._does[key]()
        elif key in self._moves:
            group, part = self._moves[key]
            self._hold(group, key, now, part)
        elif self.able.joints and self.by_joints and key in ("i", "k"):
            self._hold("arm", key, now, partial(self._joint_moved, 1.0 if key == "i" else -1.0))
        elif self.able.joints and key in _HAND and not self.by_joints:
            self._hold("arm", key, now, partial(self._hand_moved, *_HAND[key]))
        elif self.able.joints and self.by_joints and key in ("j", "l"):
            self._choose(self._at + (1 if key == "l" else -1))
        elif self.able.joints and key in "123456789":
            self._by_number(int(key))
        else:
            shown = "Esc" if key == "escape" else key
            self.said = f"the key {shown!r} has no meaning here"

    def command(self, now: float) -> Command:
        """What the keys mean at a time of the world's clock, s."""
        self._pressed = {g: p for g, p in self._pressed.items() if now < p.until - 1e-9}
        command = Command(now, stop=self._stop, ended=self.leaving)
        self._stop = False
        if self.leaving:
            return command
        for press in self._pressed.values():
            command = press.part(command)
        return command

    def _hold(self, group: str, key: str, now: float, part: Callable[[Command], Command]) -> None:
        before = self._pressed.get(group)
        repeated = before is not None and before.key == key and now - before.at <= GAP
        self._pressed[group] = _Press(key, now, now + (HELD if repeated else DEAD_MAN), part)

    def _stop_all(self) -> None:
        self._pressed.clear()
        self._stop, self.said = True, "stopped"

    def _add_base(self) -> None:
        for key, shares in _DRIVE.items():
            self._moves[key] = "base", partial(self._driven, *shares)
        for key, share in _SLIDE.items() if self.able.base and self.able.base.sideways else ():
            self._moves[key] = "base", partial(self._slid, share)
        self._does["+"] = self._does["="] = partial(self._scale, "base_share", FASTER)
        self._does["-"] = self._does["_"] = partial(self._scale, "base_share", 1.0 / FASTER)

    def _add_arm(self) -> None:
        self._does["m"] = self._switch
        self._does["."] = self._does[">"] = partial(self._scale, "arm_share", FASTER)
        self._does[","] = self._does["<"] = partial(self._scale, "arm_share", 1.0 / FASTER)
        if self.able.lift is not None:
            for key, way in (("t", 1.0), ("g", -1.0)):
                self._moves[key] = "arm", partial(self._lifted, way)

    def _add_head(self) -> None:
        keys = (("A", "D", self.able.pan), ("W", "S", self.able.tilt))
        for one, other, joint in keys:
            if joint is not None:
                name, speed = joint
                self._moves[one] = "head", partial(_turned, name, HEAD * speed)
                self._moves[other] = "head", partial(_turned, name, -HEAD * speed)

    def _scale(self, name: str, factor: float) -> None:
        setattr(self, name, min(1.0, max(LEAST, getattr(self, name) * factor)))

    def _switch(self) -> None:
        self.by_joints = not self.by_joints
        self._pressed.pop("arm", None)

    def _choose(self, at: int) -> None:
        self._at = at % len(self.able.joints)
        self._pressed.pop("arm", None)

    def _by_number(self, number: int) -> None:
        if not self.by_joints:
            self.said = "press m first: numbers choose a joint of the arm"
        elif number > len(self.able.joints):
            self.said = f"the arm has {len(self.able.joints)} joints"
        else:
            self._choose(number - 1)

    def _driven(self, ahead: float, left: float, command: Command) -> Command:
        linear, angular = self.base_speed
        return replace(command, linear=ahead * linear, angular=left * angular)

    def _slid(self, left: float, command: Command) -> Command:
        sideways = 0.0 if self.able.base is None else self.able.base.sideways
        return replace(command, lateral=left * self.base_share * sideways)

    def _hand_moved(self, axis: int, way: float, command: Command) -> Command:
        speed = self.hand_speed[0 if axis < 3 else 1]
        twist: Any = tuple(way * speed if i == axis else 0.0 for i in range(6))
        hand: Twist = twist
        return replace(command, hand=hand)

    def _joint_moved(self, way: float, command: Command) -> Command:
        return _turned(self.joint, way * self.joint_speed, command)

    def _lifted(self, way: float, command: Command) -> Command:
        name = str(self.able.lift)
        return _turned(name, way * self.able.joints[name], command)


def _turned(joint: str, speed: float, command: Command) -> Command:
    return replace(command, joints={**command.joints, joint: speed})


def _opened(opening: float, command: Command) -> Command:
    return replace(command, opening=opening)
