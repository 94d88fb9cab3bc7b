"""What is estimated of a robot: its joints' zeros, its camera's mounting and lens, its wheels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from momantu_bt.geometry import Array, Transform
from momantu_skills.calibration.poses import skew

MOUNT = (
    "camera's pitch",
    "camera's yaw",
    "camera's roll",
    "camera's place to the right",
    "camera's place downwards",
    "camera's place ahead",
)
"""A rotation vector, rad, and a shift, m, in the optical frame: x right, y down, z ahead."""
LENS = "focal length"
WHEELS = ("wheel radius", "track", "left to right wheel")
"""Factors minus one; the last is how much larger the right wheel is than the left one."""
_JOINT, _SLIDE = 0.1, 0.03
_TURN, _SHIFT = 0.1, 0.03
_FACTOR = 0.05
"""How far off a robot may be before it is calibrated, standard deviations in rad, m and 1. Where
the views tell nothing, it keeps what its description says."""


@dataclass(frozen=True)
class Parameters:
    """The order of the parameters: a zero per joint, six of the mounting, one lens, three wheels.

    joints: names; slides: those that are prismatic. track: between left and right wheels, m.
    """

    joints: tuple[str, ...]
    slides: frozenset[str]
    track: float

    @cached_property
    def names(self) -> tuple[str, ...]:
        """In words, in order."""
        return (*(f"zero of {name}" for name in self.joints), *MOUNT, LENS, *WHEELS)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """rad, m, or "" for a factor minus one."""
        zeros = ["m" if name in self.slides else "rad" for name in self.joints]
        return (*zeros, *["rad"] * 3, *["m"] * 3, "", "", "", "")

    @cached_property
    def usual(self) -> Array:
        """Standard deviations before anything was seen."""
        zeros = [_SLIDE if name in self.slides else _JOINT for name in self.joints]
        return np.array([*zeros, *[_TURN] * 3, *[_SHIFT] * 3, *[_FACTOR] * 4])

    @property
    def count(self) -> int:
        """How many."""
        return len(self.names)

    @property
    def mount(self) -> slice:
        """Where the mounting is."""
        return slice(len(self.joints), len(self.joints) + 6)

    @property
    def lens(self) -> int:
        """Where the focal length is."""
        return len(self.joints) + 6

    @property
    def wheels(self) -> slice:
        """Where the wheels are."""
        return slice(self.lens + 1, self.lens + 4)


def columns(wanted: Sequence[str], having: Sequence[str]) -> list[int]:
    """Where names are among others."""
    return [list(having).index(name) for name in wanted]


def mounted(mount: Array) -> Transform:
    """The pose of the true camera in the described one, from the six parameters of MOUNT."""
    twist = np.zeros((4, 4))
    twist[:3, :3], twist[:3, 3] = skew(mount[:3]), mount[3:]
    return Transform.from_matrix(expm(twist))
