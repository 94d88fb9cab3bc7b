"""A place in a file, and its line with a caret under it."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

KeyPath: TypeAlias = tuple[str | int, ...]
"""Keys and indices from the top of a YAML file down to a value."""

_WIDEST = 120
"""At most so many characters of a line are shown."""
_LONGEST_STRETCH = 5000
"""A word is searched in this many characters; scripts and lists of codes are shorter."""


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A part of one line in a file. line, column: from 1; length: in characters."""

    file: str
    line: int = 1
    column: int = 1
    length: int = 1

    def __str__(self) -> str:
        """`file:line:column`, as editors understand it."""
        return f"{self.file}:{self.line}:{self.column}"

    def seen_from(self, here: Place) -> str:
        """In words, for a message at another place: "line 3", or "line 3 of b.yaml"."""
        return f"line {self.line}" + (f" of {self.file}" if self.file != here.file else "")


NOWHERE = Place("", 0, 0, 0)
"""For things without a place in a file."""


@lru_cache(maxsize=16)
def lines_of(text: str) -> tuple[str, ...]:
    """The lines of a text as YAML counts them; `str.splitlines` splits at more characters."""
    return tuple(re.split(r"\r\n|\r|\n", text))


def within(place: Place, word: str, source: Mapping[str, str]) -> Place:
    """The place of a word in the line of a place; the place itself if the word is not there."""
    lines = lines_of(source.get(place.file, ""))
    line = lines[place.line - 1] if 0 < place.line <= len(lines) else ""
    begin = place.column - 1
    stretch = line[begin : begin + max(place.length, _LONGEST_STRETCH)]
    at = stretch.find(word)
    while at >= 0 and re.match(r"\w", stretch[at + len(word) : at + len(word) + 1]):
        at = stretch.find(word, at + 1)
    return place if at < 0 else Place(place.file, place.line, begin + at + 1, len(word))


def excerpt(place: Place, text: str, note: str = "") -> str:
    """The place's line with its number, and below it a caret under the place, then a note.

      3 |     - pik: $can
        |       ^^^ did you mean pick?

    text: of the whole file. If the file has no such line, the result is the note alone. The caret
    is at the right column even with tabs, wide characters and very long lines.
    """
    lines = lines_of(text)
    if not text or not 0 < place.line <= len(lines):
        return f"  {note}" if note else ""
    return marked(place, lines[place.line - 1], note)


def marked(place: Place, line: str, note: str = "") -> str:
    """As `excerpt`, given only the line of the place."""
    shown, carets = underlined(line, place.column - 1, place.length)
    number = str(place.line)
    below = f"  {' ' * len(number)} | {carets}{' ' + note if note else ''}"
    return f"  {number} | {shown}\n{below}"


def underlined(line: str, start: int, length: int) -> tuple[str, str]:
    """A line as a terminal shows it, and the carets to print below it.

    start: index of the first character to mark. length: number of characters; at least one is
    marked.
    """
    line, start = _window(line, start)
    marked = line[start : start + max(1, length)]
    gap = "".join("\t" if c == "\t" else " " * cells(c) for c in line[:start])
    carets = "^" * max(1, sum(map(cells, marked)))
    shown = "".join(
        c if c == "\t" or c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line
    )
    return shown, gap + carets


def cells(character: str) -> int:
    """The width of a character in cells of a terminal."""
    if unicodedata.category(character) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _window(text: str, column: int) -> tuple[str, int]:
    """The part of a long line around a column, and the column within that part."""
    if len(text) <= _WIDEST:
        return text, column
    start = max(0, column - _WIDEST // 2)
    return text[start : start + _WIDEST], column - start
