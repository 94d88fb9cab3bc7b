"""Comments as XML can hold them: two dashes must not stand together there."""

from __future__ import annotations

import re

_DASHES = re.compile(r"-(\\*)(?=-)")
_APART = re.compile(r"-(\\*)\\(?=-)")


def hide_dashes(comment: str) -> str:
    r"""A comment without `--`: a backslash stands between, `-\-`."""
    return _DASHES.sub(r"-\1\\", comment)


def show_dashes(comment: str) -> str:
    """What `hide_dashes` was given."""
    return _APART.sub(r"-\1", comment)
