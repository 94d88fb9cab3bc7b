"""The OpenMP runtime, which Pinocchio's wheel needs and some machines lack."""

from __future__ import annotations

from momantu_bt.shared_library import ensure_shared_library

RUNTIME = "libgomp.so.1"
"""GNU's OpenMP runtime, in Debian's package libgomp1; a minimal system does not have it."""


def ensure_openmp() -> None:
    """Load the runtime before the first `import pinocchio`: the system's, or else torch's copy."""
    ensure_shared_library(RUNTIME, carriers=("torch",))
