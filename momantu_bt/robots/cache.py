"""Where assembled URDFs are kept: in the user's cache, or in a folder that goes away."""

from __future__ import annotations

import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path

from momantu_bt.vulkan.places import cache_folder

DIGITS = 16


def keep_urdf(name: str, text: bytes) -> Path:
    """Write a URDF whole or not at all, under a name that its text decides; its path."""
    file = f"{name}-{hashlib.sha256(text).hexdigest()[:DIGITS]}.urdf"
    for folder in (_users_folder, _passing_folder):
        try:
            path = folder() / file
            if not path.is_file() or path.read_bytes() != text:
                _write_whole(path, text)
        except OSError:
            continue
        return path
    raise OSError("neither the user's cache nor the folder of temporary files can be written")


def _users_folder() -> Path:
    folder = cache_folder() / "robots"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _passing_folder() -> Path:
    return Path(_temporary().name)


@cache
def _temporary() -> tempfile.TemporaryDirectory[str]:
    """Removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="momantu_bt-")


def _write_whole(path: Path, text: bytes) -> None:
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(text)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
