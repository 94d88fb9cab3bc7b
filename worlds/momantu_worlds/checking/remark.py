"""What one check says of one episode, before episodes are put together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from momantu_bt.findings import Severity

Place: TypeAlias = tuple[str | int, ...]
"""Keys and indices from the top of a world file down to what is meant."""


@dataclass(frozen=True, slots=True)
class Remark:
    """One thing that is wrong in one episode.

    code, place and about tell remarks apart: the same in several episodes is one finding, which
    keeps the words of the episode with the greatest `amount`.
    """

    severity: Severity
    code: str
    place: Place
    about: tuple[str, ...]
    message: str
    cure: str
    amount: float = 0.0
