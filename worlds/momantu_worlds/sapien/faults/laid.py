"""Pose of the item lying on its side."""

from __future__ import annotations

import math

from momantu_bt.geometry import Transform, quaternion_from_axis_angle
from momantu_worlds.scenes.geometry.support import UprightCylinder


def lying(item: UprightCylinder, x: float, y: float, floor: float, direction: float) -> Transform:
    """`map_from_item` of the item after it fell over: its foot's rim stays on (x, y).

    floor: height of what it lies on, m. direction: in which it fell, rad.
    """
    along = math.cos(direction), math.sin(direction)
    turn = quaternion_from_axis_angle((-along[1], along[0], 0.0), math.pi / 2)
    return Transform((x, y, floor + item.radius), turn)
