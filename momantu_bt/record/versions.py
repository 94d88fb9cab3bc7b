"""Which versions made a run: of this package, Python, and the libraries it loaded."""

from __future__ import annotations

import platform
import sys
from functools import cache
from importlib import metadata

from momantu_bt.version import __version__

LIBRARIES = {
    "numpy": "numpy",
    "py_trees": "py-trees",
    "sapien": "sapien",
    "pinocchio": "pin",
    "coal": "coal",
    "ompl": "ompl",
    "toppra": "toppra",
    "numba": "numba",
    "scipy": "scipy",
    "cv2": "opencv-python-headless",
    "pyapriltags": "pyapriltags",
    "torch": "torch",
}
"""Modules whose results a run may depend on, and the distributions they come from."""


def versions() -> dict[str, str]:
    """Versions by name; a library counts only when the run has loaded it."""
    found = {"momantu-bt": __version__, "python": platform.python_version()}
    for module, distribution in LIBRARIES.items():
        if module in sys.modules:
            found[distribution] = _version(distribution)
    return found


@cache
def _version(distribution: str) -> str:
    """Version of a distribution; cached, because the look-up is slow and is done twice a run."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "unknown"
