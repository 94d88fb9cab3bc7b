"""How far the hand turns between the views, and about how many axes: what can be told at all."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.poses import Poses, quaternions

LEAST = math.radians(1.0)
"""rad; turns about an axis that are smaller than this determine nothing."""
GOOD = math.radians(10.0)


def spread(outer: Poses) -> tuple[Array, Array]:
    """Typical angles (3,) in rad between two views about three axes, largest first, and the axes.

    The axes (3, 3), a row each, are in the hand's frame with the eye in the hand, and in the base's
    frame with the eye on the base: the frame in which the eye is fixed.
    """
    first, second = np.triu_indices(len(outer), 1)
    if len(first) > 20_000:
        even = np.linspace(0, len(first) - 1, 20_000).astype(int)
        first, second = first[even], second[even]
    between = np.swapaxes(outer.rotations[second], -1, -2) @ outer.rotations[first]
    vectors = 2.0 * quaternions(between)[:, 1:]
    values, axes = np.linalg.eigh(np.einsum("mi,mj->ij", vectors, vectors) / len(vectors))
    return np.sqrt(np.clip(values[::-1], 0.0, None)), axes[:, ::-1].T


def check_spread(outer: Poses, frame: str) -> Array:
    """The typical angles of `spread`; frame: "hand" or "base", in which the eye is fixed.

    Raises:
        CalibrationError: the hand does not turn, or about one axis only.
    """
    turned, axes = spread(outer)
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
