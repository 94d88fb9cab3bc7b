"""Nearest names: "did you mean" for unknown ones."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from itertools import islice

_MOST_COMPARED = 300
"""Known names that a mistyped one is compared with."""
_MOST_LISTED = 60
"""Known names that a hint lists."""
_MOST_MEANT = 3
"""Names that are offered where they are equally like what is written."""
_LEAST_LIKE = 0.6
"""difflib's ratio from which on a name is like another."""


def nearest(word: str, candidates: Iterable[str]) -> str | None:
    """The known name that a mistyped one most likely means."""
    return next(iter(_equally_near(word, candidates)), None)


def valid_names(word: str, candidates: Iterable[str], what: str) -> str:
    """A hint: the nearest names when there are some, else all of them ("Places: a, b")."""
    names = list(dict.fromkeys(candidates))
    near = _equally_near(word, names)
    if near:
        *others, last = near
        said = f"{', '.join(others)} or {last}" if others else last
        return f"did you mean {said}?"
    listed = names[:_MOST_LISTED] + ["…"] * (len(names) > _MOST_LISTED)
    return f"{what}: {', '.join(listed)}" if names else f"there are no {what}"


def _equally_near(word: str, candidates: Iterable[str]) -> list[str]:
    """The known names that are nearest to a mistyped one; several if they are equally near."""
    folded = {_folded(name): name for name in candidates}
    exact = folded.get(_folded(word))
    if exact is not None:
        return [exact]
    compared = islice(folded, _MOST_COMPARED)
    close = difflib.get_close_matches(_folded(word), compared, n=_MOST_MEANT, cutoff=_LEAST_LIKE)
    best = _likeness(word, close[0]) if close else 0.0
    return [folded[name] for name in close if _likeness(word, name) == best]


def _folded(name: str) -> str:
    return name.lower().replace("-", "_")


def _likeness(word: str, folded: str) -> float:
    return difflib.SequenceMatcher(None, folded, _folded(word)).ratio()
