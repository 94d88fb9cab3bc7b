"""The goal that a tree or a command gives a run, in the place of the world's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

if TYPE_CHECKING:
    from momantu_bt.descriptions.goal import GoalDemand

WORLDS_OWN, NO_GOAL = "world", "none"
"""The goals that are words: what the world itself demands; nothing."""


@dataclass(frozen=True, slots=True)
class Goal:
    """What the referee demands. place: where that is written: `tree.yaml:4`, `--goal`."""

    demands: tuple[GoalDemand, ...]
    place: str


@runtime_checkable
class DemandingWorld(Protocol):
    """A world whose referee can be told what to demand."""

    def demand(self, goal: Goal | None) -> None:
        """Demand this instead of the world's own goal; None: nothing. Called before the first step.

        Raises:
            WorldError: the episode has no such object, surface or marker.
        """
        ...


@runtime_checkable
class GoalNames(Protocol):
    """A world's entry that knows which names a goal can have."""

    def goal_names(self) -> Mapping[str, Sequence[str]]:
        """Names of objects (`item`), of surfaces (`on`), and of what can be `beside` them."""
        ...
