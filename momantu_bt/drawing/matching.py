"""Match the nodes of two trees.

Nodes are matched from the roots down. Children of two matched nodes are paired by content, in an
order that both have, as alike as possible. An unmatched node that stands elsewhere unchanged has
moved.
"""

from __future__ import annotations

import hashlib
from bisect import bisect_left
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.tree.model import Document, Handler, Literal, Node
from momantu_bt.tree.show.printing import below, handler_text, unwrap

MOST_COMPARED = 250_000
"""Pairs of children that are compared with each other; longer lists are matched by equality."""


@dataclass(eq=False, slots=True)
class Unit:
    """A node with its decorators, outermost first. role: its role for its parent.

    digest: equal for units with equal content, including everything below. own: the same for the
    unit alone. size: number of units, including everything below.
    """

    node: Node
    around: tuple[Node, ...]
    role: str
    again: tuple[str, ...] = ()
    kids: list[Unit] = field(default_factory=list)
    own: str = ""
    digest: str = ""
    size: int = 1

    def walk(self) -> list[Unit]:
        """The unit and everything below it, in the order of the file."""
        found: list[Unit] = []
        stack = [self]
        while stack:
            unit = stack.pop()
            found.append(unit)
            stack.extend(reversed(unit.kids))
        return found

    def kind(self) -> tuple[str, str | None]:
        """Only units of one kind can be the same node, changed."""
        return self.node.type, self.node.target


@dataclass(slots=True)
class Matching:
    """Pairs of units, one of each document. placed: in the same place; moved: with all below."""

    placed: list[tuple[Unit, Unit]] = field(default_factory=list)
    moved: list[tuple[Unit, Unit]] = field(default_factory=list)


def units(document: Document) -> dict[str, Unit]:
    """The root unit of each tree."""
    return {name: _unit(tree.root) for name, tree in document.trees.items()}


def _unit(outer: Node) -> Unit:
    root = Unit(*_split(outer), "")
    order, stack = list[Unit](), [root]
    while stack:
        unit = stack.pop()
        order.append(unit)
        again: list[str] = []
        for role, each in below(unit.node):
            if not isinstance(each, Handler):
                unit.kids.append(Unit(*_split(each), role))
            elif each.node is not None:
                unit.kids.append(Unit(*_split(each.node), handler_text(each)))
            else:
                again.append(handler_text(each))
        unit.again = tuple(again)
        stack.extend(unit.kids)
    for unit in reversed(order):
        unit.own = _hash(_said(unit.node), [_said(each) for each in unit.around], unit.again)
        unit.digest = _hash(unit.own, [(kid.role, kid.digest) for kid in unit.kids])
        unit.size += sum(kid.size for kid in unit.kids)
    return root


def _split(outer: Node) -> tuple[Node, tuple[Node, ...]]:
    node, around = unwrap(outer)
    return node, tuple(around)


def _said(node: Node) -> tuple[object, ...]:
    ports = sorted((name, plain(value)) for name, value in node.ports.items())
    conditions = sorted(node.conditions.items())
    return node.type, node.target, node.name, node.note, node.disabled, ports, conditions


def plain(value: Any) -> str:
    """A port's value as a text that equal values share."""
    if isinstance(value, Literal):
        return f"={plain(value.value)}"
    if isinstance(value, Mapping):
        items = sorted((str(key), plain(item)) for key, item in value.items())
        return "{" + ",".join(f"{key!r}:{item}" for key, item in items) + "}"
    if isinstance(value, list | tuple):
        return "[" + ",".join(map(plain, value)) + "]"
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return repr(value)


def _hash(*parts: object) -> str:
    return hashlib.sha256(repr(parts).encode("utf-8", "surrogatepass")).hexdigest()


def match(first: Mapping[str, Unit], second: Mapping[str, Unit]) -> Matching:
    """Match the trees of two documents, by name and then from the roots down.

    The order of the two documents does not matter: swapped, the same units are matched.
    """
    if _hash(*_digests(first)) <= _hash(*_digests(second)):
        return _match(first, second)
    turned = _match(second, first)
    return Matching(
        [(left, right) for right, left in turned.placed],
        [(left, right) for right, left in turned.moved],
    )


def _digests(roots: Mapping[str, Unit]) -> list[tuple[str, str]]:
    return sorted((name, unit.digest) for name, unit in roots.items())


def _match(first: Mapping[str, Unit], second: Mapping[str, Unit]) -> Matching:
    matching = Matching()
    stack = [
        (first[name], second[name])
        for name in first
        if name in second and first[name].kind() == second[name].kind()
    ]
    while stack:
        left, right = stack.pop()
        matching.placed.append((left, right))
        stack += aligned(left.kids, right.kids)
    _find_moved(first, second, matching)
    return matching


def _find_moved(first: Mapping[str, Unit], second: Mapping[str, Unit], matching: Matching) -> None:
    """Unmatched units of both sides that are equal, including everything below them.

    A single node counts as moved only within its own tree; in another tree it is a new, equal node.
    """
    taken = {id(unit) for pair in matching.placed for unit in pair}
    waiting: dict[tuple[str, str], deque[Unit]] = {}
    for name, unit in _left_over(second, taken):
        waiting.setdefault(("" if unit.kids else name, unit.digest), deque()).append(unit)
    # the largest first, so that none is split
    for name, unit in sorted(_left_over(first, taken), key=lambda each: -each[1].size):
        candidates = waiting.get(("" if unit.kids else name, unit.digest), deque[Unit]())
        while candidates and id(unit) not in taken:
            other = candidates.popleft()
            if id(other) not in taken:
                matching.moved.append((unit, other))
                taken.update(id(each) for whole in (unit, other) for each in whole.walk())


def _left_over(roots: Mapping[str, Unit], taken: set[int]) -> list[tuple[str, Unit]]:
    """Units without a partner, with the names of their trees, in the order of the file."""
    return [
        (name, unit)
        for name, root in roots.items()
        for unit in root.walk()
        if id(unit) not in taken
    ]


def aligned(left: Sequence[Unit], right: Sequence[Unit]) -> list[tuple[Unit, Unit]]:
    """Pairs of children in an order that both lists have, as alike as possible in all."""
    start = 0
    while start < min(len(left), len(right)) and _equal(left[start], right[start]):
        start += 1
    end = 0
    while end < min(len(left), len(right)) - start and _equal(left[-1 - end], right[-1 - end]):
        end += 1
    pairs = [*zip(left[:start], right[:start], strict=True)]
    middle = left[start : len(left) - end], right[start : len(right) - end]
    if len(middle[0]) * len(middle[1]) <= MOST_COMPARED:
        pairs += _best(*middle)
    else:
        pairs += _equal_ones(*middle)
    return [*pairs, *zip(left[len(left) - end :], right[len(right) - end :], strict=True)]


def _equal(left: Unit, right: Unit) -> bool:
    return left.digest == right.digest and left.role == right.role


def _alike(left: Unit, right: Unit) -> int:
    """0: not the same node; more, the more alike."""
    if left.kind() != right.kind():
        return 0
    if left.digest == right.digest:
        return 6 + (left.role == right.role)
    named = left.node.name is not None and left.node.name == right.node.name
    return 1 + 3 * named + (left.own == right.own) + (left.role == right.role)


def _best(left: Sequence[Unit], right: Sequence[Unit]) -> list[tuple[Unit, Unit]]:
    """The longest common subsequence, weighted by likeness."""
    score = [[0] * (len(right) + 1) for _ in range(len(left) + 1)]
    for i in reversed(range(len(left))):
        for j in reversed(range(len(right))):
            alike = _alike(left[i], right[j])
            both = score[i + 1][j + 1] + alike if alike else 0
            score[i][j] = max(score[i + 1][j], score[i][j + 1], both)
    pairs: list[tuple[Unit, Unit]] = []
    i = j = 0
    while i < len(left) and j < len(right):
        alike = _alike(left[i], right[j])
        if alike and score[i][j] == score[i + 1][j + 1] + alike:
            pairs.append((left[i], right[j]))
            i, j = i + 1, j + 1
        elif score[i][j] == score[i + 1][j]:
            i += 1
        else:
            j += 1
    return pairs


def _equal_ones(left: Sequence[Unit], right: Sequence[Unit]) -> list[tuple[Unit, Unit]]:
    """Equal units, as many as stand in one order in both lists: a longest rising subsequence."""
    places: dict[str, list[int]] = {}
    for index in reversed(range(len(right))):
        places.setdefault(right[index].digest, []).append(index)
    found = [(unit, places[unit.digest].pop()) for unit in left if places.get(unit.digest)]
    ends: list[int] = []  # where the best rising sequence of each length ends so far
    lasts: list[int] = []
    before: list[int | None] = []
    for number, (_, index) in enumerate(found):
        length = bisect_left(lasts, index)
        before.append(ends[length - 1] if length else None)
        lasts[length : length + 1], ends[length : length + 1] = [index], [number]
    pairs: list[tuple[Unit, Unit]] = []
    at = ends[-1] if ends else None
    while at is not None:
        unit, index = found[at]
        pairs.append((unit, right[index]))
        at = before[at]
    return pairs[::-1]
