"""A kind of fault: a row of the entry points `momantu_bt.faults`.

A kind names no skill, no code of a skill and no subtree. It names activities and symptoms; skills
say which are theirs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from momantu_bt.activity import Activity
from momantu_bt.fault import FaultParameter
from momantu_bt.skill import Port
from momantu_bt.symptom import Symptom

FOR = "for"
"""The parameter for how long a fault lasts, s; infinity: it never ends."""


class Where(StrEnum):
    """Where a fault acts; lists of faults are in this order."""

    ROBOT = "robot"
    """at the robot's boundary, whatever the world"""
    WORLD = "world"
    """in the surroundings, made by the world"""
    SITE = "site"
    """in what the robot is told"""
    SKILL = "skill"
    """in a skill of the tree"""
    PROCESS = "process"


@dataclass(frozen=True, slots=True)
class Trigger:
    """When a fault usually begins: while the first skill of a tree that does something runs.

    after: if given, the fault begins this many seconds after that skill ended in SUCCESS instead.
    """

    activity: Activity
    after: float | None = None

    def phase(self, skill: str, behind: str) -> str:
        """The phase, as `--fault` writes it. behind: see `Skill.activities`."""
        if self.after is None:
            return f"{skill}{behind}"
        return f"after-{skill}" + (f"+{self.after:g} s" if self.after else "")


@dataclass(frozen=True, slots=True)
class Variant:
    """The same fault with other parameters, as another row of the matrix.

    parameters: as they are written, such as `for=inf`.
    """

    parameters: str
    recoverable: bool


@dataclass(frozen=True, slots=True)
class FaultKind:
    """One kind of fault.

    begins: its usual triggers; the first that the tree has counts. If it has none, the start does.
    notice: seconds within which a robot must notice it.
    symptoms: what skills may notice of it. codes: failure codes of the engine that are a true
    reason to give up because of it; the codes of skills follow from the symptoms.
    actuator: which one it breaks, as skills name it in `uses`; "" for none.
    ends_process: it ends the process, so the run cannot give a reason.
    """

    component: str
    mode: str
    doc: str
    place: Where
    begins: tuple[Trigger, ...]
    notice: float
    recoverable: bool
    symptoms: frozenset[Symptom] = frozenset()
    codes: frozenset[str] = frozenset()
    parameters: tuple[Port, ...] = ()
    variants: tuple[Variant, ...] = ()
    actuator: str = ""
    ends_process: bool = False

    @property
    def name(self) -> str:
        """`component.mode`."""
        return f"{self.component}.{self.mode}"

    @property
    def defaults(self) -> Mapping[str, FaultParameter]:
        """The default of each parameter."""
        return {port.name: port.default for port in self.parameters}


def fault_kind(
    name: str,
    doc: str,
    *parameters: Port,
    place: Where,
    symptoms: Iterable[Symptom] = (),
    codes: Iterable[str] = (),
    **more: Any,
) -> FaultKind:
    """A kind of fault by its name, `component.mode`; more: the other fields of FaultKind."""
    component, _, mode = name.partition(".")
    return FaultKind(
        component,
        mode,
        doc,
        place,
        parameters=parameters,
        symptoms=frozenset(symptoms),
        codes=frozenset(codes),
        **more,
    )


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
