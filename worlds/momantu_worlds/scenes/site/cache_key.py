"""Cache keys for what is computed from world files."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path


def cache_key(parts: Iterable[bytes | str]) -> str:
    """A key for what the code of `scenes` computes from these parts: 20 hexadecimal digits."""
    hashed = hashlib.blake2b(_code(), digest_size=10)
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        hashed.update(len(data).to_bytes(8, "big") + data)
    return hashed.hexdigest()


@cache
def _code() -> bytes:
    """Digest of all modules of `scenes`: a change of the code makes every old entry invalid."""
    hashed = hashlib.blake2b(digest_size=10)
    root = Path(__file__).parents[1]
    for path in sorted(root.rglob("*.py")):
        hashed.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return hashed.digest()
