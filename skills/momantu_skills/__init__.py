"""What a robot can do: skills, services, and the code below them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from momantu_bt.lazy import lazily

with lazily():
    from momantu_skills import diagnosis

if TYPE_CHECKING:
    from momantu_bt.diagnosis import Diagnosis


def diagnose() -> Iterator[Diagnosis]:
    """For `momantu-bt doctor`: whether the libraries of skills load."""
    return diagnosis.diagnose()
