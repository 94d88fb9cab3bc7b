"""Where robots act: robots, scenes and the simulator."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from momantu_bt.lazy import lazily

with lazily():
    from momantu_worlds import diagnosis

if TYPE_CHECKING:
    from momantu_bt.diagnosis import Diagnosis


def diagnose() -> Iterator[Diagnosis]:
    """For `momantu-bt doctor`: whether worlds can be built and rendered."""
    return diagnosis.diagnose()
