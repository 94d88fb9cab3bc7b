"""Trees that come as a text or as plain values, and not as a file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from momantu_bt.errors import InputError
from momantu_bt.formats.yaml.writer import quoted, scalar

SHOWN = "<tree>"
"""The file name in messages about a text."""
MAX_DEPTH = 200
"""Deepest nesting of plain values; the reader of files allows less."""
_MISREAD = frozenset(("yes", "no", "on", "off", "true", "false", "null", "~"))
"""Texts that need quotes, as other YAML versions read them differently."""


@dataclass(frozen=True, slots=True)
class TreeText:
    """A tree's text, YAML or XML. shown: what messages call its file."""

    text: str
    shown: str = SHOWN


AnyTree: TypeAlias = str | Path | TreeText | Mapping[str, Any]
"""A tree: a path, a bundled tree's name, a text, or what a YAML file would hold."""


def tree_source(tree: AnyTree) -> str | TreeText:
    """What a caller means by a tree: a path or a bundled tree's name, or a text.

    A `Path` is a file. A mapping is what a YAML file would hold. A `str` with a line break, or one
    that begins with `<` or `{`, is a text; any other is a path or a bundled tree's name.

    Raises:
        InputError: it is none of these, or the mapping holds something that YAML cannot.
    """
    if isinstance(tree, Path):
        return str(tree)
    if isinstance(tree, str):
        is_text = "\n" in tree or tree.lstrip().startswith(("<", "{"))
        return TreeText(tree) if is_text else tree
    if isinstance(tree, TreeText):
        return tree
    if isinstance(tree, Mapping):
        return TreeText("\n".join(_lines(tree, "the tree", 0)) + "\n")
    kind = type(tree).__name__
    raise InputError(f"a tree is a path, a bundled tree's name, a text or a mapping, not {kind}")


def _lines(value: Any, place: str, depth: int) -> Iterator[str]:
    """A mapping or list in YAML's block style. place: where it is, for messages."""
    if depth > MAX_DEPTH:
        raise InputError(f"the tree is nested more than {MAX_DEPTH} deep, or contains itself")
    if isinstance(value, Mapping):
        for key, item in value.items():
            here = f"{place}[{key!r}]"
            yield from _entry(f"{_key(key, place)}:", item, here, depth)
    else:
        for index, item in enumerate(value):
            yield from _entry("-", item, f"{place}[{index}]", depth)


def _entry(head: str, item: Any, place: str, depth: int) -> Iterator[str]:
    if not _is_list(item) and not isinstance(item, Mapping):
        yield f"{head} {_scalar(item, place)}".rstrip()
    elif not item:
        yield f"{head} {'{}' if isinstance(item, Mapping) else '[]'}"
    else:
        below = _lines(item, place, depth + 1)
        if head == "-":
            yield f"- {next(below)}"
        else:
            yield head
        yield from (f"  {line}" for line in below)


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str | bytes | bytearray)


def _key(key: Any, place: str) -> str:
    if isinstance(key, bool | int | str):
        return _scalar(key, place)
    raise InputError(f"{place} has the key {key!r}; expected a text or a whole number")


def _scalar(value: Any, place: str) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value) if value.lower() in _MISREAD else scalar(value)
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float) and math.isfinite(value):
        return repr(float(value))
    said = repr(value) if isinstance(value, float) else f"{type(value).__name__} {value!r}"
    raise InputError(
        f"{place} is {said}; a tree holds texts, finite numbers, true and false, lists and "
        "mappings. Give another value as a key: `$key` in the tree, and values={'key': …}"
    )
