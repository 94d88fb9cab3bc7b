"""Whether the episodes of a world are all alike, as far as the checks see."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from momantu_worlds.scenes.file.objects import ObjectNote
from momantu_worlds.scenes.file.summary import VARIES
from momantu_worlds.scenes.file.world import WorldFile


def is_fixed(world: WorldFile) -> bool:
    """Whether every seed gives the same bodies at the same places; light may vary."""
    if world.unknown is not None or world.distractors is not None or world.start.turn is None:
        return False
    things = [*world.objects.values(), *([] if world.item is None else [world.item])]
    if any(_is_drawn(thing) for thing in things):
        return False
    return not any(_amounts(world.model_dump(exclude={"light"})))


def _is_drawn(thing: ObjectNote) -> bool:
    sized = thing.extent is not None or thing.mesh is not None
    return thing.at is None or not sized or len(thing.tops) > 1


def _amounts(value: Any) -> Iterator[float]:
    """All amounts by which something may be moved."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key in VARIES and isinstance(inner, int | float):
                yield inner
            else:
                yield from _amounts(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _amounts(inner)
