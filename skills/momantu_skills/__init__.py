"""What a robot can do: skills, services, and the libraries they stand on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from momantu_bt.diagnosis import Diagnosis


def diagnose() -> Iterator[Diagnosis]:
    """For `momantu-bt doctor`: whether the libraries of skills load."""
    from momantu_skills.diagnosis import diagnose as look

    return look()
