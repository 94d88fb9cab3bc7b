"""The planning scene with what skills that move the arm need in addition to the contract."""

from __future__ import annotations

from typing import Protocol

from momantu_bt.lazy import lazily
from momantu_bt.messages import SupportPlane
from momantu_bt.world import Surface
from momantu_skills.navigation.drive.body import BodyScene

with lazily():
    from momantu_skills.manipulation.scene import scene, site_obstacles
    from momantu_skills.manipulation.scene.holding import Holding
    from momantu_skills.manipulation.scene.payload import Payload


class ArmScene(BodyScene, Protocol):
    """A planning scene for arm motions; `PlanningSceneService` implements it."""

    @property
    def scene(self) -> scene.Scene:
        """The robot's body, its surroundings, and collision worlds made of both."""
        ...

    @property
    def floor_plan(self) -> site_obstacles.FloorPlan:
        """The obstacles that the site's maps know."""
        ...

    @property
    def holding(self) -> Holding:
        """What the fingers say of the held object."""
        ...

    @property
    def payload(self) -> Payload:
        """The weight in the hand."""
        ...

    def touched(self) -> None:
        """Report that the hand has just touched or released something."""
        ...

    def released(self) -> None:
        """Report that the hand has just released the held object."""
        ...

    def support(self, plane: SupportPlane) -> None:
        """Add a measured surface."""
        ...

    def surface_found(self, name: str, surface: Surface) -> None:
        """From now on believe that a surface of the site is where it was found."""
        ...

    def take_over_site(self) -> None:
        """Place the site's surfaces and what hangs over them; none while not localized."""
        ...
