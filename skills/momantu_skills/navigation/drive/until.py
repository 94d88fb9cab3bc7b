"""A drive that ends early: when there is nothing more to see from where it leads, for example."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

from momantu_bt.failure import Failure
from momantu_bt.skill import Run


def until(way: Generator[Any, Any, Any], over: Callable[[], bool]) -> Run:
    """Run a drive to its end, or until `over()` after one of its ticks."""
    go: Callable[[Any], Any] = way.send
    value: Any = None
    while True:
        try:
            step = go(value)
        except StopIteration:
            return
        try:
            value, go = (yield step), way.send
        except Failure as failure:
            value, go = failure, way.throw
        except GeneratorExit:
            way.close()
            raise
        if isinstance(step, str) and over():
            way.close()
            return
