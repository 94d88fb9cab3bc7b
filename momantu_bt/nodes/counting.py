"""The count of tries or rounds, as displays show it: `try 2 of 3`."""

from __future__ import annotations

from momantu_bt.tree.model import Literal, Node


def count_text(word: str, number: int, most: int | None) -> str:
    """`try 2 of 3`; without an end or with an unknown one `try 2`. number: from 1."""
    of = "" if most is None or most < 0 else f" of {max(number, most)}"
    return f"{word} {number}{of}"


def written_count(model: Node, port: str, default: int = -1) -> int | None:
    """The number that a tree file gives a port; None for a key."""
    value = model.ports.get(port, Literal(default))
    if not isinstance(value, Literal):
        return None
    try:
        return int(value.value)
    except (TypeError, ValueError):
        return None
