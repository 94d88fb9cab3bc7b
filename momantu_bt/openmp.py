"""The OpenMP runtime that Pinocchio's wheel expects of the machine, also where there is none."""

from __future__ import annotations

import ctypes
import importlib.util
from pathlib import Path

RUNTIME = "libgomp.so.1"

_loaded: list[ctypes.CDLL] = []


def ensure_openmp() -> None:
    """Load GNU's OpenMP runtime, before the first `import pinocchio`.

    The machine's own is taken where there is one (Debian's package libgomp1; a fresh minimal
    system has none), else the one that torch's wheel carries. A library loaded under this name is
    found by those that need it. Where neither is there, the import says what is missing.
    """
    if _loaded:
        return
    torch = importlib.util.find_spec("torch")
    folders = [] if torch is None else list(torch.submodule_search_locations or [])
    for path in (RUNTIME, *(str(Path(folder) / "lib" / RUNTIME) for folder in folders)):
        try:
            _loaded.append(ctypes.CDLL(path))
        except OSError:
            continue
        return
