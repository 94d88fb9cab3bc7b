"""How far the hand turns between the views, and about how many axes: what can be told at all."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.poses import Poses, turns_between

LEAST = math.radians(1.0)
"""rad; turns about an axis that are smaller than this determine nothing."""
GOOD = math.radians(10.0)


def check_spread(outer: Poses, frame: str) -> Array:
    """The typical angles of `turns_between`; frame: "hand" or "base", in which the eye is fixed.

    Raises:
        CalibrationError: the hand does not turn, or about one axis only.
    """
    turned, axes = turns_between(outer)
    degrees = ", ".join(f"{math.degrees(each):.2g}" for each in turned)
    if turned[0] < LEAST:
        raise CalibrationError(
            f"all views are alike: the hand turns by {degrees} deg about three axes. Neither where "
            f"the camera is nor how it is turned can be told; turn the hand by 20 deg or more "
            f"about two axes"
        )
    if turned[1] < LEAST:
        axis = axes[0] * (1.0 if axes[0][np.argmax(abs(axes[0]))] > 0 else -1.0)
        words = ", ".join(f"{each:.2f}" for each in axis + 0.0)
        raise CalibrationError(
            f"the hand turns about one axis only, ({words}) of the {frame} ({degrees} deg about "
            f"three axes). Where the camera is along that axis cannot be told, and how it is "
            f"turned about it hardly; turn the hand by 20 deg or more about a second axis too"
        )
    return turned
