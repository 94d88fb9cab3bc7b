"""Contacts of a hand that turns with what it holds.

Without persistent contacts, PhysX keeps the contact points of two bodies that do not move against
each other. It moves them along with the bodies, but leaves their normals as they were in the world:
a hand that turns by 30 degrees would press what it holds sideways, as if its pads had not turned.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

TURN = math.radians(1.0)
"""How far a hand turns before its contacts are found anew: normals are never more off than this."""


class FreshContacts:
    """Has the contacts of a hand found anew while it turns."""

    def __init__(self, links: Iterable[Any]) -> None:
        """links: of one hand, SAPIEN's; those without shapes do not count."""
        found = [link for link in links if link.collision_shapes]
        self._shapes = [shape for link in found for shape in link.collision_shapes]
        self._link = found[0] if found else None
        self._least = math.cos(TURN / 2)
        self._found = np.zeros(4)

    def refresh(self) -> None:
        """Forget the contacts if the hand has turned since they were found."""
        if self._link is None:
            return
        turn = self._link.entity_pose.q
        if abs(float(turn @ self._found)) > self._least:
            return
        self._found = turn
        for shape in self._shapes:  # whoever may touch a shape is asked again, and so is how
            shape.set_collision_groups(shape.get_collision_groups())
