"""Models of lenses: how pixels depend on directions."""

from __future__ import annotations

from enum import StrEnum


class Model(StrEnum):
    """Pinhole with 5 (plumb bob) or 8 (rational) distortion coefficients, or fisheye with 4."""

    PINHOLE = "pinhole"
    PINHOLE8 = "pinhole8"
    FISHEYE = "fisheye"
