"""What is known of one kind of fault, before any run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from momantu_bt.fault import FaultParameter
from momantu_bt.skill import Port

FIRST_SKILL = "<first skill>"
"""A usual phase: while the tree's first skill runs."""
FIRST_ANSWER = "<first skill with outputs>"
"""A usual phase: while the first skill of the tree that has outputs runs."""
FOR = "for"
"""The parameter that says how long a fault lasts, s; infinity: for good."""


class Where(StrEnum):
    """Where a fault enters."""

    ROBOT = "robot"
    """at the robot's boundary, whatever the world"""
    SITE = "site"
    """in what the robot is told"""
    WORLD = "world"
    """in the surroundings, made by the world"""
    SKILL = "skill"
    """in a skill of the tree"""
    PROCESS = "process"


@dataclass(frozen=True, slots=True)
class Variant:
    """The same fault with other parameters, where that makes another row of the matrix.

    parameters: as they are written, such as `for=inf`.
    """

    parameters: str
    recoverable: bool


@dataclass(frozen=True, slots=True)
class FaultKind:
    """One kind of fault.

    phases: its usual ones; the first that the tree has is taken, else it begins at the start.
    notice: seconds within which a robot must notice it.
    reasons: failure codes that are a true reason to give up because of it.
    ends_process: nothing of the run is left to give a reason.
    """

    component: str
    mode: str
    doc: str
    place: Where
    phases: tuple[str, ...]
    notice: float
    recoverable: bool
    reasons: frozenset[str]
    parameters: tuple[Port, ...] = ()
    variants: tuple[Variant, ...] = ()
    ends_process: bool = False

    @property
    def name(self) -> str:
        """`component.mode`."""
        return f"{self.component}.{self.mode}"

    @property
    def defaults(self) -> Mapping[str, FaultParameter]:
        """Each parameter's value where nobody gives one."""
        return {port.name: port.default for port in self.parameters}


def number(
    name: str,
    default: float,
    unit: str | None,
    doc: str,
    least: float | None = None,
    most: float | None = None,
) -> Port:
    """A parameter that is a number; unit None: a factor or the like."""
    return Port(name, "in", float, doc, default, unit, least=least, most=most)


def count(name: str, default: int, doc: str, least: int = 0) -> Port:
    """A parameter that counts something."""
    return Port(name, "in", int, doc, default, least=least)


def word(name: str, default: str, doc: str) -> Port:
    """A parameter that is a text."""
    return Port(name, "in", str, doc, default)


def lasting(seconds: float) -> Port:
    """`for`: how long it lasts."""
    return number(FOR, seconds, "s", "how long it lasts; inf: for good", least=0.0)
