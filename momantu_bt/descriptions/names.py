"""What was probably meant by a name that is unknown."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MOST_LISTED = 30
"""Names that a message lists at most."""


def nearest(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name: `; did you mean 'arm_link_1'?`, or all names."""
    names = list(dict.fromkeys(known))
    near = difflib.get_close_matches(name, names, n=3)
    if near:
        return f"; did you mean {' or '.join(repr(each) for each in near)}?"
    listed = names[:MOST_LISTED] + ["…"] * (len(names) > MOST_LISTED)
    return f"; there are: {', '.join(listed)}" if names else "; there is none"
