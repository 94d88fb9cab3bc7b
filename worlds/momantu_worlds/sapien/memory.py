"""Giving back what an earlier episode of the same process has left."""

from __future__ import annotations

import ctypes
import gc


def tidy() -> None:
    """Collect cycles, in which a closed scene hangs, and return free pages to the system.

    Without it a process that runs many episodes grows: scenes hold buffers that Python does not
    count, so that it collects them late, between allocations that then stay.
    """
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc alone has it
    if trim is not None:
        trim(0)
