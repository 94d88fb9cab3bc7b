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
"""Size in bytes, larger than the mutex of any libc; a mutex of zeros is open."""


class Raises(SkillFault):
    """`skill.exception`."""

    def before(self, skill: Skill) -> None:
        """Raise an error that no skill declares."""
        raise RuntimeError(f"{self.fault.name} was asked for")


class Hangs(SkillFault):
    """`skill.hang`: an endless loop, which the handler of a signal can end."""

    def before(self, skill: Skill) -> None:
        """Loop for ever."""
        while True:
            pass


class HangsInNativeCode(SkillFault):
    """`skill.hang_native`: takes a lock twice while it holds the interpreter's lock.

    Then no handler of a signal and no other thread of the interpreter ever runs.
    """

    def before(self, skill: Skill) -> None:
        """Never return."""
        lock = ctypes.PyDLL(None).pthread_mutex_lock
        mutex = ctypes.create_string_buffer(_MUTEX)
        while True:
            lock(mutex)


class NotANumber(SkillFault):
    """`skill.nan`."""

    def after(self, skill: Skill) -> None:
        """Replace each number in its outputs by NaN."""
        for name, value in _outputs(skill):
            skill.port_values[name] = without_numbers(value)


class Nonsense:
    """A type that no skill declares."""


class WrongType(SkillFault):
    """`skill.wrong_type`."""

    def after(self, skill: Skill) -> None:
        """Give a value of the wrong type at each output."""
        for name, _ in _outputs(skill):
            skill.port_values[name] = Nonsense()


class Slow(SkillFault):
    """`skill.slow`: works longer in each step, and each step takes more ticks."""

    def before(self, skill: Skill) -> None:
        """Use up time without any result."""
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
    """The same value with NaN for each float; whole numbers stay, as they have no NaN.

    A transform keeps its rotation: its constructor refuses a rotation without length.
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
