"""Texts as XML holds them: attributes, text between tags, comments."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.formats.text import NOT_TEXT, Beside
from momantu_bt.formats.xml.comments import hide_dashes
from momantu_bt.tree.files.scalars import CannotWrite

_ESCAPES = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"}
_ESCAPES |= {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}


def fits_in_xml(text: str) -> bool:
    """Whether XML has all the characters of a text."""
    return NOT_TEXT.search(text) is None


def attribute(name: str, text: str) -> str:
    """` name="text"`.

    Raises:
        CannotWrite: XML has no such character.
    """
    return f' {name}="{escaped(text)}"'


def escaped(text: str, *, between: bool = False) -> str:
    """A text for an attribute, or with `between` for use between tags.

    Raises:
        CannotWrite: XML has no such character.
    """
    found = NOT_TEXT.search(text)
    if found is not None:
        raise CannotWrite(f"the character U+{ord(found[0]):04X} cannot stand in XML")
    kept = '\n\t"' if between else ""
    return "".join(c if c in kept else _ESCAPES.get(c, c) for c in text)


def above(comments: Sequence[str], pad: str, *, every: bool = False) -> list[str]:
    """Comments on lines of their own. every: include those that stand beside something."""
    own = [c for c in comments if every or not isinstance(c, Beside)]
    return [pad + _comment(text) for text in own]


def beside(comments: Sequence[str]) -> str:
    """The comments at the end of a line."""
    return "".join(f" {_comment(c)}" for c in comments if isinstance(c, Beside))


def _comment(text: str) -> str:
    allowed = NOT_TEXT.sub("\N{REPLACEMENT CHARACTER}", text)
    return f"<!-- {hide_dashes(allowed)} -->"
