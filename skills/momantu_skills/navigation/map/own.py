"""A localization that makes the map itself, while the robot drives on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from momantu_bt.service import Localization

if TYPE_CHECKING:
    from momantu_skills.navigation.map.costmap import Costmap


class OwnMap(Localization, Protocol):
    """What such a service offers; see `momantu_bt.service.offers`."""

    @property
    def costmap(self) -> Costmap:
        """The costmap on the growing map, which all who drive share; its raster may grow."""
        ...

    @property
    def loops(self) -> int:
        """How many loops are closed."""
        ...

    def refresh(self) -> None:
        """Bring the costmap up to date with the newest scan; it lags behind by up to a second."""
        ...
