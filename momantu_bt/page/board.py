"""The blackboard over time: keys that were written, and what services published."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from typing import Any

from momantu_bt.page.tables import Texts, value_text
from momantu_bt.record.codec import from_json
from momantu_bt.record.recording import Recording

_SERVICE = "/service/"


def board(recording: Recording) -> dict[str, Any]:
    """Columns and tables of what was written when.

    keys: names of the root's keys, then of its subtrees' in the order of the tree, then of those
    that services publish, with the mark `@` that trees use.
    values: texts. writes: columns tick, key, value. It keeps repeated writes of the same value, but
    not repeated publications by a service.
    """
    keys, values = Texts(), Texts()
    entries = [*_written(recording), *_published(recording)]
    for name in sorted({name for _, name, _ in entries}, key=_rank):
        keys.number(name)
    entries.sort(key=lambda entry: entry[0])
    columns: dict[str, list[int]] = {"tick": [], "key": [], "value": []}
    last: dict[str, str] = {}
    for tick, name, text in entries:
        if name.startswith("@") and last.get(name) == text:
            continue
        last[name] = text
        for column, number in zip(
            columns.values(), (tick, keys.number(name), values.number(text)), strict=True
        ):
            column.append(number)
    return {"keys": keys.texts, "values": values.texts, "writes": columns}


def _rank(name: str) -> tuple[bool, list[int], str]:
    """`0.1.3/Dock/side` is a key of the subtree Dock, which is at 0.1.3 in the tree."""
    path, _, _ = name.rpartition("/")
    numbers = [int(part) for part in path.partition("/")[0].split(".") if part.isdigit()]
    return name.startswith("@"), numbers, name


def _written(recording: Recording) -> Iterator[tuple[int, str, str]]:
    for index, tick in enumerate(recording.ticks):
        for cell, value in tick.writes:
            yield index, cell, value_text(value)


def _published(recording: Recording) -> Iterator[tuple[int, str, str]]:
    times = [tick.now for tick in recording.ticks]
    for topic in recording.topics():
        if not topic.startswith(_SERVICE):
            continue
        name = topic.removeprefix(_SERVICE)
        for time, message in recording.messages(topic):
            index = min(bisect_left(times, time - 1e-6), len(times) - 1)
            for key, value in message.items():
                yield index, f"@{name}.{key}", value_text(from_json(value))
