"""What all bombs share: small things that want to become large."""

from __future__ import annotations

import random
import string
from collections.abc import Callable
from typing import TypeAlias

Bomb: TypeAlias = Callable[[int, random.Random], str]
"""A text of about so many of something, up to LARGEST."""

LARGEST = 100_000
HEAD = "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n"


def word(r: random.Random, length: int = 8) -> str:
    """A word that means nothing."""
    return "".join(r.choices(string.ascii_lowercase, k=length))
