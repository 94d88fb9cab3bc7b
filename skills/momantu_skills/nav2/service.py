"""The service nav2_servers: what Nav2's servers keep between two goals of a tree."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.descriptions.tunables import configured
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot
from momantu_bt.service import Service, ServiceContext
from momantu_skills.navigation.config import NavigationConfig

with lazily():
    from momantu_skills.navigation.map import costmap


class Nav2Service(Service):
    """Keeps one costmap for all leaves, and remembers which actions a tree has cancelled.

    The leaves themselves look, when they plan, drive or check. config: the tunables of `navigate`.
    """

    rate: ClassVar[float] = 1.0
    senses = ("laser",)

    def start(self, context: ServiceContext) -> None:
        """Start with the map alone."""
        parameters = context.site.services.get("navigate", {})
        self.config = configured(NavigationConfig, parameters, "navigate")
        self.costmap: costmap.Costmap = costmap.of_site(context.site, self.config)
        self._cancels: dict[str, int] = {}

    def update(self, robot: Robot, now: float) -> None:
        """Do nothing: the leaves look when they need to."""

    def cancel(self, action: str) -> None:
        """End an action, such as `FollowPath`, wherever it runs now."""
        self._cancels[action] = self.cancels(action) + 1

    def cancels(self, action: str) -> int:
        """How often an action was cancelled so far; it ends when the number grows."""
        return self._cancels.get(action, 0)

    def published(self) -> Mapping[str, Any]:
        """Nothing."""
        return {}
