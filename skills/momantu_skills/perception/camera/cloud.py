"""Convert depth pictures to point clouds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

RAMP = 0.03
"""A pixel that differs by more than this, m, from both neighbours, in opposite directions, lies
between a near and a far surface and on neither. No real surface within 2 m is that steep."""


def points_from_depth(depth: NDArray[np.float32], intrinsics: Array, stride: int = 1) -> Array:
    """Points (n, 3) in the optical frame, m, of every `stride`-th pixel with a measurement.

    Pinhole model: x = (u - cx) z / fx. Pixels between two surfaces are removed; see RAMP.
    """
    z = np.asarray(depth[::stride, ::stride], dtype=np.float64)
    rows, columns = np.nonzero((z > 0.0) & ~on_ramp(z))
    z = z[rows, columns]
    x = (columns * stride - intrinsics[0, 2]) / intrinsics[0, 0] * z
    y = (rows * stride - intrinsics[1, 2]) / intrinsics[1, 1] * z
    return np.column_stack([x, y, z])


def on_ramp(z: Array) -> NDArray[np.bool_]:
    """Which pixels lie between a near and a far surface, (h, w) bool; see RAMP."""
    ramp = np.zeros(z.shape, dtype=bool)
    for axis in (0, 1):
        step = np.diff(z, axis=axis)
        rising, falling = step > RAMP, step < -RAMP
        before, after = (slice(None, -1), slice(1, None))
        middle: list[slice] = [slice(None), slice(None)]
        middle[axis] = slice(1, -1)
        first = (before, slice(None)) if axis == 0 else (slice(None), before)
        second = (after, slice(None)) if axis == 0 else (slice(None), after)
        both = (rising[first] & rising[second]) | (falling[first] & falling[second])
        ramp[tuple(middle)] |= both
    return ramp
