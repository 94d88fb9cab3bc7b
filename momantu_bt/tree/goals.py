"""The goal that a document writes, and the names that it uses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.goal import NO_GOAL, WORLDS_OWN, Goal
from momantu_bt.lazy import lazily
from momantu_bt.tree.model import Document, Literal

with lazily():
    from momantu_bt.descriptions import goal as demands

OPTION = "--goal"
"""The file name of a goal that stands on the command line."""

_WHAT = (("item", "object"), ("on", "surface"), ("beside", "tag or body"))


def given_goal(document: Document, value: Any) -> None:
    """Set a goal in the place of the document's own, as `--goal` does."""
    text = str(value)
    document.goal, document.goal_place = Literal(value), Place(OPTION, 1, 1, max(1, len(text)))
    document.source[OPTION] = text


def is_word(document: Document) -> bool:
    """Whether the goal is one of the words `world` and `none`, or there is none."""
    return document.goal is None or document.goal.value in (WORLDS_OWN, NO_GOAL)


def goal_of(document: Document) -> Goal | None:
    """What the document itself demands; None for the words.

    Raises:
        ValueError: what is written is no goal; the message says why.
    """
    if document.goal is None or is_word(document):
        return None
    return Goal(demands.parse_demands(document.goal.value), _words(document.goal_place))


def unknown_names(goal: Goal, names: Mapping[str, Sequence[str]]) -> Iterator[tuple[str, str]]:
    """A message and a hint for each name that the world does not have."""
    for demand in goal.demands:
        for key, what in _WHAT:
            name = getattr(demand, key)
            if name is not None and name not in names[key]:
                yield f"the world has no {what} {name!r}", valid_names(name, names[key], f"{what}s")
        if demand.beside == demand.item:
            yield f"{demand.item!r} cannot stand beside itself", "name a tag or another body"


def _words(place: Place | None) -> str:
    if place is None or place.file == OPTION:
        return OPTION
    return f"{PurePath(place.file).name}:{place.line}"
