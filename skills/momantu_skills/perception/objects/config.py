"""Tunables of object detection."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from momantu_bt.descriptions.tunables import Tunables
from momantu_bt.detector import DETECTORS
from momantu_bt.formats.names import valid_names


def _installed(name: str) -> str:
    if name not in DETECTORS:
        raise ValueError(
            f"no detector is called {name!r}; {valid_names(name, DETECTORS, 'installed')}"
        )
    return name


class DetectionConfig(Tunables):
    """How `detect_object` finds objects where the tree says nothing of it."""

    detector: Annotated[str, AfterValidator(_installed)] = Field(
        default="geometric", description="the detector that finds objects in the pictures"
    )
