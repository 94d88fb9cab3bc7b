"""The scalars, lists and mappings of a YAML text, each with its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from momantu_bt.formats.places import Place


@dataclass(slots=True)
class Scalar:
    """A text, number, true, false or None. text: as written. quoted: it is in quotes.

    size, depth: number of values in it and depth of their nesting, those behind aliases included.
    """

    value: Any
    text: str
    quoted: bool
    place: Place
    size: int = 1
    depth: int = 1


@dataclass(slots=True)
class Items:
    """A list."""

    items: list[Raw]
    place: Place
    size: int = 1
    depth: int = 1


@dataclass(slots=True)
class Entries:
    """A mapping: its keys and values in file order. flow: it is written with braces."""

    entries: list[tuple[Scalar, Raw]]
    place: Place
    flow: bool = False
    size: int = 1
    depth: int = 1


Raw: TypeAlias = Scalar | Items | Entries


def plain_value(raw: Raw) -> Any:
    """The value without places; of several equal keys, the last one counts."""
    # The recursion is safe: the reader limits the depth of a file.
    if isinstance(raw, Scalar):
        return raw.value
    if isinstance(raw, Items):
        return [plain_value(item) for item in raw.items]
    return {key.text: plain_value(value) for key, value in raw.entries}
