"""The planning scene as skills that move the arm need it: more than the contract."""

from __future__ import annotations

from typing import Protocol

from momantu_bt.lazy import lazily
from momantu_bt.messages import SupportPlane
from momantu_bt.service import PlanningScene

with lazily():
    from momantu_skills.manipulation.scene import scene, site_obstacles


class ArmScene(PlanningScene, Protocol):
    """A planning scene that arms are planned in; `PlanningSceneService` is one."""

    @property
    def scene(self) -> scene.Scene:
        """The robot's body, its surroundings, and collision worlds made of both."""
        ...

    @property
    def floor_plan(self) -> site_obstacles.FloorPlan:
        """The obstacles that the site's maps know."""
        ...

    def touched(self) -> None:
        """Say that the hand has just touched or let go of something."""
        ...

    def released(self) -> None:
        """Say that the hand has just let go of what it held."""
        ...

    def support(self, plane: SupportPlane) -> None:
        """Take over a measured surface."""
        ...
