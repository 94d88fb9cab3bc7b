"""Hints for unknown names: "did you mean" with the nearest known ones."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from itertools import islice

_MOST_COMPARED = 300
"""At most so many known names are compared with a mistyped one."""
_MOST_LISTED = 60
"""At most so many known names are listed in a hint."""
_MOST_MEANT = 3
"""At most so many equally near names are offered."""
_LEAST_LIKE = 0.6
"""Names with at least this ratio of difflib count as near."""


def listed(words: Sequence[str], last: str = "and") -> str:
    """Words as a sentence lists them: `a, b and c`. last: the word before the last one."""
    *others, end = words
    return f"{', '.join(others)} {last} {end}" if others else end


def counted(number: int, what: str) -> str:
    """`1 tree`, `2 trees`."""
    return f"{number} {what}{'s' * (number != 1)}"


def nearest(word: str, candidates: Iterable[str], least: float = _LEAST_LIKE) -> str | None:
    """The known name that is nearest to a mistyped one.

    least: the least likeness that counts as near, from 0 to 1 (the same but for capitals). One of
    two names that begins with the other is near in any case.
    """
    return next(iter(_equally_near(word, candidates, least)), None)


def valid_names(word: str, candidates: Iterable[str], what: str, least: float = _LEAST_LIKE) -> str:
    """A hint with the nearest names; without any, it lists all names ("Places: a, b")."""
    names = list(dict.fromkeys(candidates))
    near = _equally_near(word, names, least)
    if near:
        return f"did you mean {listed(near, 'or')}?"
    shown = names[:_MOST_LISTED] + ["…"] * (len(names) > _MOST_LISTED)
    return f"{what}: {', '.join(shown)}" if names else f"there are no {what}"


def _equally_near(word: str, candidates: Iterable[str], least: float) -> list[str]:
    """The known names that are nearest to a mistyped one; several if they are equally near."""
    folded = {_folded(name): name for name in candidates}
    exact = folded.get(_folded(word))
    if exact is not None:
        return [exact]
    compared = islice(folded, _MOST_COMPARED)
    cutoff = min(least, _LEAST_LIKE)
    close = difflib.get_close_matches(_folded(word), compared, n=_MOST_MEANT, cutoff=cutoff)
    close = [name for name in close if _likeness(word, name) >= least or _begins(word, name, least)]
    best = _likeness(word, close[0]) if close else 0.0
    return [folded[name] for name in close if _likeness(word, name) == best]


def _begins(word: str, folded: str, least: float) -> bool:
    """Whether one of two names is the beginning of the other, unless only the same name counts."""
    shown = _folded(word)
    return least < 1.0 and (folded.startswith(shown) or shown.startswith(folded))


def _folded(name: str) -> str:
    return name.lower().replace("-", "_")


def _likeness(word: str, folded: str) -> float:
    return difflib.SequenceMatcher(None, folded, _folded(word)).ratio()
