"""The cache of assembled URDFs."""

from __future__ import annotations

import hashlib
from pathlib import Path

from momantu_bt.formats.cache import kept_folder
from momantu_bt.formats.files import write_whole

DIGITS = 16


def keep_urdf(name: str, text: bytes) -> Path:
    """Write a URDF whole or not at all, under a name that its text decides; its path.

    Raises:
        OSError: neither the user's cache nor the folder of temporary files can be written.
    """
    path = kept_folder("robots") / f"{name}-{hashlib.sha256(text).hexdigest()[:DIGITS]}.urdf"
    if not path.is_file() or path.read_bytes() != text:
        write_whole(path, text)
    return path
