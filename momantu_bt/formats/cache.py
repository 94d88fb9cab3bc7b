"""The user's cache folder."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

CACHE_VARIABLE = "MOMANTU_BT_CACHE"
"""Environment variable for another cache folder, for example if the home is read-only."""


def cache_folder() -> Path:
    """`$MOMANTU_BT_CACHE`, else `$XDG_CACHE_HOME/momantu-bt`, else `~/.cache/momantu-bt`."""
    named = os.environ.get(CACHE_VARIABLE)
    if named:
        return Path(named).expanduser().absolute()
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache").absolute() / "momantu-bt"


def cache_subfolder(kind: str) -> Path:
    """A folder for one kind of file, in the user's cache or, if that is read-only, temporary.

    Raises:
        OSError: neither the cache nor the folder for temporary files can be written.
    """
    with suppress(OSError):
        return _writable(cache_folder() / kind)
    return _writable(Path(_passing().name) / kind)


@cache
def _passing() -> tempfile.TemporaryDirectory[str]:
    """Removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="momantu_bt-")


def _writable(path: Path) -> Path:
    path.mkdir(parents=True, exist_ok=True)
    if not os.access(path, os.W_OK):
        raise PermissionError(f"{path} cannot be written")
    return path
