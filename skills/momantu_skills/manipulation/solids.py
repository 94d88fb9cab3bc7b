"""Corners of the solids that detected objects are taken for."""

from __future__ import annotations

from itertools import product

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject
from momantu_skills.manipulation.hulls import prism


def object_corners(thing: DetectedObject, padding: float = 0.0) -> Array:
    """Corners (n, 3) of an object's hull in its own frame, `padding` m larger on every side."""
    x, y, z = (edge + 2 * padding for edge in thing.size)
    if thing.shape == "cylinder":
        return prism(max(x, y) / 2, z)
    return np.array(list(product((-0.5, 0.5), repeat=3))) * (x, y, z)
