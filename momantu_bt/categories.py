"""The categories of things that detectors tell apart, and how a thing of each looks the same."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType


class Symmetry(StrEnum):
    """From which sides a thing looks the same. z is its axis."""

    ROUND = "round"
    """However it is turned about z."""
    ENDS = "ends"
    """As ROUND, and it may stand on its head."""
    HANDLE = "handle"
    """As ROUND unless its handle is seen, which is towards x."""
    BOX = "box"
    """Its axes may have other names."""
    NONE = "none"
    """From no other side."""


USUAL: Mapping[str, Symmetry] = MappingProxyType(
    {
        "bottle": Symmetry.ROUND,
        "bowl": Symmetry.ROUND,
        "can": Symmetry.ENDS,
        "mug": Symmetry.HANDLE,
        "box": Symmetry.BOX,
    }
)
"""The categories that are known unless pictures and weights say otherwise."""
HANDLED = tuple(name for name, symmetry in USUAL.items() if symmetry is Symmetry.HANDLE)
"""Those whose things have a handle."""


def categories_from(told: Mapping[str, str]) -> dict[str, Symmetry]:
    """Categories of a file, name -> symmetry; raises ValueError if there is no such symmetry."""
    return {str(name): Symmetry(symmetry) for name, symmetry in told.items()}
