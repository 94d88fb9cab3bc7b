"""Texts of files: which characters they may have, and comments in them."""

from __future__ import annotations

import re

NOT_TEXT = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Control characters and the like, which stand in values alone: XML cannot hold them."""


class Beside(str):
    """A comment at the end of the line of what it belongs to; a plain text stands above it."""
