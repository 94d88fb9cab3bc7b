"""object.removed: someone takes the item out of the building."""

from __future__ import annotations

import numpy as np

from momantu_bt.fault import Fault
from momantu_bt.geometry import Transform
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage

AWAY = 5.0
"""Distance of its new place beyond everything else, m."""


class Removed:
    """The item does not come back."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._stage, self._item = stage, stage.goal.item

    def begin(self) -> None:
        """Take the item away, even out of the hand."""
        prisms = self._stage.prisms(self._item)
        far = np.concatenate([prism.base.corners() for prism in prisms]).max(axis=0) + AWAY
        self._stage.move_item(Transform((float(far[0]), float(far[1]), 0.0)))

    def end(self) -> None:
        """Nothing is undone: the item stays away."""
