"""Python's garbage collector during a run: not while it starts, and not over what stays.

Starting a run allocates some four million objects that live until its end. The collector would go
through them again and again; nothing of that depends on when it does.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused() -> Iterator[None]:
    """Collect nothing inside the block, unless `frozen` is entered there."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


@contextmanager
def frozen() -> Iterator[None]:
    """Collect inside the block, but leave out what is there at its beginning."""
    was_on = gc.isenabled()
    gc.freeze()
    gc.enable()
    try:
        yield
    finally:
        gc.unfreeze()
        if not was_on:
            gc.disable()
