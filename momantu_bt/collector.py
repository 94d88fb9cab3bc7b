"""Python's garbage collector: seldom while a program starts, and in a run not over what stays.

Importing a verb and reading a tree allocate hundreds of thousands of objects that live until the
end, starting a run some four million. The collector would go through them again and again; nothing
of that depends on when it does.
"""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

_USUAL = gc.get_threshold()
"""How often Python collects by itself."""
_SELDOM = 50_000
"""New objects after which it does within `seldom`, in the place of 700."""


@contextmanager
def seldom() -> Iterator[None]:
    """Collect less often inside the block, but as often as usual within `frozen`."""
    before = gc.get_threshold()
    if before[0]:
        gc.set_threshold(max(_SELDOM, before[0]), *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)


@cache
def skip_the_last() -> None:
    """Python collects once more when a process ends; leave that out, as all memory goes with it.

    For verbs that only read: a file that nobody closed may lose what is still in its buffer.
    """
    atexit.register(gc.freeze)


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
    was_on, often = gc.isenabled(), gc.get_threshold()
    gc.freeze()
    gc.set_threshold(*_USUAL)
    gc.enable()
    try:
        yield
    finally:
        gc.unfreeze()
        gc.set_threshold(*often)
        if not was_on:
            gc.disable()
