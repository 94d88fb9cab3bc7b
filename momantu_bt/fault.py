"""Injected faults: what a fault is, and the protocol of worlds that implement some.

A fault is written `COMPONENT.MODE[@PHASE][:name=value,…]`, such as `camera.dead@12 s:for=5 s`.
Faults of sensors and actuators happen at the robot's boundary, and faults of skills in the engine,
with any robot and any world. The world makes the faults of the surroundings.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Protocol, TypeAlias, runtime_checkable

from momantu_bt.errors import MomantuError

FaultParameter: TypeAlias = float | int | str | bool


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault of one run.

    component, mode: what breaks and how. phase: when it begins, as written; None for the usual
    phase of its kind. parameters: all of them, in SI units, with defaults filled in.
    """

    component: str
    mode: str
    phase: str | None = None
    parameters: Mapping[str, FaultParameter] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def name(self) -> str:
        """`component.mode`."""
        return f"{self.component}.{self.mode}"


class Effect(Protocol):
    """A fault ready to happen. `begin` comes first; it is not called again once it succeeds."""

    def begin(self) -> None:
        """Break it now; the world stands between two ticks.

        Raises:
            FaultError: the fault cannot happen now (it would move an object that is held, say).
                Nothing has changed, and `begin` may be called again a tick later.
        """
        ...

    def end(self) -> None:
        """Mend it, for a fault that lasts a while."""
        ...


@runtime_checkable
class FaultyWorld(Protocol):
    """A world that can break itself."""

    def faults(self) -> tuple[str, ...]:
        """Names of the faults that it can make, `component.mode`."""
        ...

    def effect(self, fault: Fault) -> Effect:
        """Prepare a fault; nothing happens before `begin`.

        Raises:
            FaultError: the world cannot make it, or not with these parameters.
        """
        ...


class FaultError(MomantuError):
    """A fault that cannot be made; the message says why and what would be valid."""
