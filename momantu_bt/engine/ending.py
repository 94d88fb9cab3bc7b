"""How a run ended."""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.failure import FailureValue
from momantu_bt.world import Verdict

SUCCESS, FAILURE, INTERRUPTED, ERROR = "SUCCESS", "FAILURE", "INTERRUPTED", "ERROR"
"""The four ways to end: the tree's two results, interrupted by somebody, an internal error."""


@dataclass(frozen=True, slots=True)
class Ending:
    """How a run ended. status: one of the four. error: a traceback.

    interrupted_by: name of the signal that ended it.
    """

    status: str
    failure: FailureValue | None
    verdict: Verdict | None
    sim_time: float
    wall_time: float
    ticks: int
    error: str | None
    interrupted_by: str | None = None
