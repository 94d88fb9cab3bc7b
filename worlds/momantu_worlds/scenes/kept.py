"""Names for what is worked out of a world file and kept."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path


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
