"""The first thing in which two ticks differ."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from momantu_bt.engine.encode import encode
from momantu_bt.failure import FailureValue
from momantu_bt.messages import plain
from momantu_bt.record.codec import dumps, from_json, to_json
from momantu_bt.record.recording import ChangeRecord, NodeInfo, TickRecord
from momantu_bt.skill import MISSING

NOTHING = "nothing"
_WIDEST = 200


@dataclass(frozen=True, slots=True)
class Difference:
    """The point where two runs begin to differ. left, right: what each run has there.

    kind: "tree", "time", "robot state", "published value", "status", "note", "failure", "write",
    "command" or "end". where: the node with its place, or the cell, key or actuator; empty if
    the kind says everything.
    """

    tick: int
    now: float
    kind: str
    where: str
    left: str
    right: str

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "tick": self.tick,
            "time": self.now,
            "kind": self.kind,
            "where": self.where,
            "left": self.left,
            "right": self.right,
        }


def same(left: Any, right: Any) -> bool:
    """Whether two values are equal to the last bit, as far as a record can store them."""
    return left is right or _bytes(left) == _bytes(right)


def _bytes(value: Any) -> bytes:
    return encode(from_json(to_json(value)))


def first_difference(
    left: TickRecord, right: TickRecord, nodes: Sequence[NodeInfo], *, surroundings: bool
) -> Difference | None:
    """The first difference, in the order in which a tick happens. nodes: the nodes of both runs.

    surroundings: also compare what the robot and its services reported, and its commands.
    """
    found = _outer(left, right) if surroundings else None
    found = found or _changes(left.changes, right.changes, nodes)
    found = found or _pairs("write", left.writes, right.writes)
    if surroundings:
        found = found or _pairs("command", left.issued, right.issued)
    if found is None:
        return None
    return Difference(left.number, left.now, *found)


_Found = tuple[str, str, str, str]


def _outer(left: TickRecord, right: TickRecord) -> _Found | None:
    if not same(left.now, right.now):
        return "time", "", f"{left.now!r} s", f"{right.now!r} s"
    if left.state != right.state:
        return "robot state", "", left.state or NOTHING, right.state or NOTHING
    return _pairs("published value", left.reads, right.reads)


def _changes(
    left: Iterable[ChangeRecord], right: Iterable[ChangeRecord], nodes: Sequence[NodeInfo]
) -> _Found | None:
    for one, other in zip_longest(left, right):
        if one is None or other is None or one.node != other.node:
            there = one or other
            words = _change_words(one, nodes), _change_words(other, nodes)
            return "status", node_words(nodes[there.node]), *words
        kind, mine, theirs = _parted(one, other)
        if kind:
            return kind, node_words(nodes[one.node]), mine, theirs
    return None


def _parted(one: ChangeRecord, other: ChangeRecord) -> tuple[str, str, str]:
    if one.status != other.status:
        return "status", one.status, other.status
    if one.note != other.note:
        return "note", one.note or NOTHING, other.note or NOTHING
    if not same(one.failure, other.failure):
        return "failure", *_parted_failures(one.failure, other.failure)
    return "", "", ""


def _parted_failures(one: FailureValue | None, other: FailureValue | None) -> tuple[str, str]:
    """Both in words. If the words are the same, add their data and causes."""
    short = (NOTHING if one is None else str(one), NOTHING if other is None else str(other))
    return short if short[0] != short[1] else _apart(one, other)


def _pairs(
    kind: str, left: Sequence[tuple[str, Any]], right: Sequence[tuple[str, Any]]
) -> _Found | None:
    for one, other in zip_longest(left, right):
        if one is None or other is None or one[0] != other[0]:
            there = one or other
            return kind, there[0], _pair_words(one), _pair_words(other)
        if not same(one[1], other[1]):
            return kind, one[0], *_apart(one[1], other[1])
    return None


def _pair_words(pair: tuple[str, Any] | None) -> str:
    return NOTHING if pair is None else f"{pair[0]} = {value_words(pair[1])}"


def _change_words(change: ChangeRecord | None, nodes: Sequence[NodeInfo]) -> str:
    if change is None:
        return NOTHING
    note = f" ({change.note})" if change.note else ""
    return f"{change.status}{note} of {node_words(nodes[change.node])}"


def node_words(node: NodeInfo) -> str:
    """`navigate in_front_of table_a (bring_object.yaml:41)`."""
    return f"{node.label} ({node.place.rpartition('/')[2]})"


def value_words(value: Any, widest: int = _WIDEST) -> str:
    """A value in one line for a person. A long value is cut."""
    return _cut(_short_text(value), widest)


def _apart(left: Any, right: Any) -> tuple[str, str]:
    """Both texts, which differ. If they are long, begin a little before the difference."""
    texts = _short_text(left), _short_text(right)
    if texts[0] == texts[1]:
        texts = dumps(to_json(left)), dumps(to_json(right))
    parted = next((i for i, (a, b) in enumerate(zip(*texts, strict=False)) if a != b), 0)
    start = max(0, parted - _WIDEST // 2)
    mark = "…" if start else ""
    return _cut(mark + texts[0][start:], _WIDEST), _cut(mark + texts[1][start:], _WIDEST)


def _short_text(value: Any) -> str:
    if value is MISSING:
        return NOTHING
    if isinstance(value, str):
        return value
    data = _essential(value.as_dict()) if isinstance(value, FailureValue) else value
    return json.dumps(plain(data), default=str)


def _essential(failure: dict[str, Any]) -> dict[str, Any]:
    """A failure, and its few causes, without what depends on where files lie."""
    kept = {key: value for key, value in failure.items() if key != "place"}
    kept["data"] = {key: v for key, v in failure["data"].items() if key != "traceback"}
    kept["cause"] = None if failure["cause"] is None else _essential(failure["cause"])
    kept["beside"] = [_essential(other) for other in failure["beside"]]
    return kept


def _cut(text: str, widest: int) -> str:
    return text if len(text) <= widest else text[: widest - 1] + "…"
