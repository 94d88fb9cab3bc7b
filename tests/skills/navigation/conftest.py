"""A base that obeys at once, and moves that run to their end."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

import pytest

from momantu_bt.failure import Failure
from momantu_bt.skill import Compute
from tests.skills.scenery.obedient import MakeObedient, Obedient, RunMove


@pytest.fixture(scope="session")
def obedient() -> MakeObedient:
    """`obedient(start, boxes=…, arm=…)`: see `Obedient`; the room is 8 m x 6 m from (0, 0)."""
    return Obedient


@pytest.fixture(scope="session")
def run_move() -> RunMove:
    """`run_move(move, each)`: lets a move run to its end; what it returns."""

    def run(move: Generator[Any, Any, object], each: Callable[[], None] = lambda: None) -> object:
        answer, raised = None, None
        while True:
            try:
                asked = move.send(answer) if raised is None else move.throw(raised)
            except StopIteration as end:
                return end.value
            answer = raised = None
            each()
            if isinstance(asked, Compute):
                try:
                    answer = asked.function()
                except Failure as failure:
                    raised = failure

    return run
