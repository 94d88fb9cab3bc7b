"""Where what is worked out once and kept lies: the user's cache folder."""

from __future__ import annotations

import os
from pathlib import Path

CACHE_VARIABLE = "MOMANTU_BT_CACHE"
"""Environment variable that names another cache folder, for homes that cannot be written."""


def cache_folder() -> Path:
    """`$MOMANTU_BT_CACHE`, else `$XDG_CACHE_HOME/momantu-bt`, else `~/.cache/momantu-bt`."""
    named = os.environ.get(CACHE_VARIABLE)
    if named:
        return Path(named).expanduser().absolute()
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache").absolute() / "momantu-bt"
