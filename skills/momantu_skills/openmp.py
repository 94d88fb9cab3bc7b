"""The OpenMP runtime, which Pinocchio's wheel needs and a machine may lack."""

from __future__ import annotations

from momantu_bt.shared_library import ensure_shared_library

RUNTIME = "libgomp.so.1"
"""GNU's; Debian's package libgomp1 holds it, and a fresh minimal system has none."""


def ensure_openmp() -> None:
    """Load it before the first `import pinocchio`: the machine's, else the one of torch's wheel."""
    ensure_shared_library(RUNTIME, carriers=("torch",))
