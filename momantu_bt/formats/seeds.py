"""Seeds as people write them: `0:500`, `3,5,7`, `0:10,20:30`."""

from __future__ import annotations

import re
from collections.abc import Iterable

from momantu_bt.errors import MomantuError

MOST = 1_000_000
"""Most seeds in one bench."""
MOST_NAMED = 8
"""Most seeds that one line lists."""
_PART = re.compile(r"(\d+)(?::(\d+))?")
_VALID = "write 0:500 (500 itself is not among them), 3,5,7 or 0:10,20:30"


class SeedsError(MomantuError, ValueError):
    """A text is not a list of seeds; the message says what would be valid."""


def parse_seeds(text: str) -> tuple[int, ...]:
    """Read seeds from a text, in its order, without duplicates.

    Raises:
        SeedsError: the text has none of the forms, a range is empty, or there are too many.
    """
    found: dict[int, None] = {}
    for part in text.split(","):
        match = _PART.fullmatch(part.strip())
        if match is None:
            raise SeedsError(
                f"{part.strip()!r} in --seeds {text} is neither a seed nor a range; {_VALID}"
            )
        first = int(match[1])
        end = first + 1 if match[2] is None else int(match[2])
        if end <= first:
            raise SeedsError(f"the range {part.strip()} in --seeds {text} is empty; {_VALID}")
        if end - first > MOST or len(found) > MOST:
            raise SeedsError(f"--seeds {text} are more than {MOST} seeds")
        found.update(dict.fromkeys(range(first, end)))
    return tuple(found)


def seeds_text(seeds: Iterable[int]) -> str:
    """Seeds in order; three or more in a row become a range: `12, 40-47`."""
    runs: list[list[int]] = []
    for seed in sorted(set(seeds)):
        if runs and seed == runs[-1][-1] + 1:
            runs[-1].append(seed)
        else:
            runs.append([seed])
    parts = [f"{run[0]}-{run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return ", ".join(parts)


def few_seeds(seeds: Iterable[int]) -> str:
    """Seeds as a short text that fits into a line: `seeds 3, 40-47 and 12 more`."""
    found = sorted(set(seeds))
    more = f" and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    return f"seed{'s' if len(found) > 1 else ''} {seeds_text(found[:MOST_NAMED])}{more}"
