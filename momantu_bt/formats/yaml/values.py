"""The scalars, lists and mappings of a YAML text, each with its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from momantu_bt.formats.places import Place


@dataclass(slots=True)
class Scalar:
    """A text, number, true, false or nothing (None). text: as written; quoted: in quotes.

    size, depth: how many values it holds and how deep they are nested, aliases counted.
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
    """A mapping: its keys and values in the order of the file. flow: written with braces."""

    entries: list[tuple[Scalar, Raw]]
    place: Place
    flow: bool = False
    size: int = 1
    depth: int = 1


Raw: TypeAlias = Scalar | Items | Entries


def plain_value(raw: Raw) -> Any:
    """The value alone; mappings keep the last of several equal keys."""
    # as deep as the file, whose depth has a bound
    if isinstance(raw, Scalar):
        return raw.value
    if isinstance(raw, Items):
        return [plain_value(item) for item in raw.items]
    return {key.text: plain_value(value) for key, value in raw.entries}
