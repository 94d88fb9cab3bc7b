"""Escaping of comments for XML, which does not allow `--` in them."""

from __future__ import annotations

import re

_DASHES = re.compile(r"-(\\*)(?=-)")
_APART = re.compile(r"-(\\*)\\(?=-)")


def hide_dashes(comment: str) -> str:
    r"""Escape a comment for XML: `--` becomes `-\-`."""
    return _DASHES.sub(r"-\1\\", comment)


def show_dashes(comment: str) -> str:
    """Undo `hide_dashes`."""
    return _APART.sub(r"-\1", comment)
