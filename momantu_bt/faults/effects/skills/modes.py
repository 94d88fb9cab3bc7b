"""The modes in which a skill can fail."""

from __future__ import annotations

import ctypes
import math
import time
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from momantu_bt.faults.effects.skills.victim import SkillFault
from momantu_bt.geometry import Transform
from momantu_bt.skill import Compute, Skill

_MUTEX = 128
"""Bytes, more than any libc's mutex has; all zero is an open one."""


class Raises(SkillFault):
    """`skill.exception`."""

    def before(self, skill: Skill) -> None:
        """Raise what no skill declares."""
        raise RuntimeError(f"{self.fault.name} was asked for")


class Hangs(SkillFault):
    """`skill.hang`: an endless loop, which a signal's handler can leave."""

    def before(self, skill: Skill) -> None:
        """Run in circles."""
        while True:
            pass


class HangsInNativeCode(SkillFault):
    """`skill.hang_native`: a lock that is taken twice, with the interpreter's lock held.

    No handler of a signal ever runs, and no other thread of the interpreter.
    """

    def before(self, skill: Skill) -> None:
        """Never come back."""
        lock = ctypes.PyDLL(None).pthread_mutex_lock
        mutex = ctypes.create_string_buffer(_MUTEX)
        while True:
            lock(mutex)


class NotANumber(SkillFault):
    """`skill.nan`."""

    def after(self, skill: Skill) -> None:
        """Make each number that it gives NaN."""
        for name, value in _outputs(skill):
            skill.port_values[name] = without_numbers(value)


class Nonsense:
    """Of no type that a skill declares."""


class WrongType(SkillFault):
    """`skill.wrong_type`."""

    def after(self, skill: Skill) -> None:
        """Give something else at each output."""
        for name, _ in _outputs(skill):
            skill.port_values[name] = Nonsense()


class Slow(SkillFault):
    """`skill.slow`: works longer in each step, and each step takes more ticks."""

    def before(self, skill: Skill) -> None:
        """Work for nothing."""
        until = time.perf_counter() + float(self.fault.parameters["wall"])
        while time.perf_counter() < until:
            pass

    def longer(self, said: str | Compute) -> Iterator[str | Compute]:
        """The same phase for more ticks, or the same work with more time."""
        factor = float(self.fault.parameters["factor"])
        if isinstance(said, Compute):
            yield replace(said, budget=said.budget * factor)
        else:
            yield from [said] * math.ceil(factor)


def _outputs(skill: Skill) -> Iterator[tuple[str, object]]:
    for port in skill.ports.values():
        if port.direction == "out" and port.name in skill.port_values:
            yield port.name, skill.port_values[port.name]


def without_numbers(value: Any) -> Any:
    """The same value, each float in it NaN; whole numbers have no NaN and stay.

    A transform keeps its turn: one of no length is refused where it is made.
    """
    if isinstance(value, float):
        return math.nan
    if isinstance(value, Transform):
        return Transform((math.nan,) * 3, value.quaternion)
    if isinstance(value, np.ndarray) and value.dtype.kind == "f":
        return np.full_like(value, math.nan)
    if type(value) in (list, tuple):
        return type(value)(without_numbers(item) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: without_numbers(getattr(value, f.name)) for f in fields(value) if f.init}
        return replace(value, **parts)
    return value
