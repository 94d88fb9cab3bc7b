"""Finds the comments of a YAML text, which the YAML parser skips."""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

_COMMENT = re.compile(r"(?<!\S)#([^\r\n]*)")


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment in the file, without its `#`. beside: it follows something on the same line.

    A line that begins with `#|` continues the comment in the line above it.
    """

    line: int
    column: int
    text: str
    beside: bool


def span(event: Any) -> list[tuple[int, int]]:
    """The place of a scalar's text; after `|` and `>` the text begins on the next line."""
    start, end = event.start_mark.index, event.end_mark.index
    if event.style not in ("|", ">"):
        return [(start, end)]
    below = re.compile(r"[\r\n]").search(event.start_mark.buffer, start)
    return [] if below is None else [(below.start(), end)]


def comments(text: str, spans: list[tuple[int, int]]) -> list[Comment]:
    """The comments of a text. spans: places of its scalars, in which `#` starts no comment."""
    found: list[Comment] = []
    starts = [0, *(match.end() for match in re.finditer(r"\r\n|\r|\n", text))]
    position = 0
    for start, end in [*spans, (len(text), len(text))]:
        for match in _COMMENT.finditer(text, position, start):
            line = bisect_right(starts, match.start())
            before = text[starts[line - 1] : match.start()]
            words, beside = match[1].removeprefix(" ").rstrip(), bool(before.strip())
            last = found[-1] if found else None
            if last is not None and words.startswith("|") and match[1].startswith("|"):
                height = last.text.count("\n") + 1
                if line == last.line + height and not beside and not last.beside:
                    joined = f"{last.text}\n{match[1][1:].rstrip()}"
                    found[-1] = Comment(last.line, last.column, joined, False)
                    continue
            found.append(Comment(line, len(before) + 1, words, beside))
        position = end
    return found
