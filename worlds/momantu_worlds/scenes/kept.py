"""What is worked out of a world file and kept: in the user's cache folder, or a passing one."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path

from momantu_bt.vulkan.places import cache_folder


def folder(kind: str) -> Path:
    """A folder that can be written, for one kind of thing.

    Raises:
        OSError: neither the user's cache folder nor that of temporary files can be written.
    """
    with suppress(OSError):
        return _writable(cache_folder() / kind)
    return _writable(_passing() / kind)


def put(file: Path, content: bytes) -> None:
    """Write a file whole or not at all, whoever else writes or reads it; raises OSError."""
    handle, name = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    part = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)


def digest(parts: Iterable[bytes | str]) -> str:
    """A name for what is made of these parts, by the code of this package."""
    hashed = hashlib.blake2b(_code(), digest_size=10)
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        hashed.update(len(data).to_bytes(8, "big") + data)
    return hashed.hexdigest()


@cache
def _code() -> bytes:
    """Digest of the modules beside this one: after an update nothing old is used."""
    hashed = hashlib.blake2b(digest_size=10)
    for path in sorted(Path(__file__).parent.glob("*.py")):
        hashed.update(path.name.encode() + path.read_bytes())
    return hashed.digest()


@cache
def _passing() -> Path:
    return Path(tempfile.mkdtemp(prefix="momantu-bt-"))


def _writable(path: Path) -> Path:
    path.mkdir(parents=True, exist_ok=True)
    if not os.access(path, os.W_OK):
        raise PermissionError(f"{path} cannot be written")
    return path
