"""Show the difference between two documents, as a tree with + - ~ marks."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from momantu_bt.drawing.matching import Unit, match, plain, units
from momantu_bt.tree.catalogue.wording import value_text
from momantu_bt.tree.model import Document, Literal, PortValue, Tree
from momantu_bt.tree.show.printing import heading, text, title

SAME, ADDED, REMOVED, CHANGED = " ", "+", "-", "~"


@dataclass(frozen=True, slots=True)
class Marked:
    """One line. mark: SAME, ADDED, REMOVED or CHANGED."""

    mark: str
    depth: int
    text: str


def difference(first: Document, second: Document) -> list[Marked]:
    """The changes from the first to the second; nothing if they mean the same.

    A node that moved without a change is one changed line, at its place in the second document.
    If nothing below a node differs, that part is left out ("…").
    """
    return [*_header(first, second), *_Difference(first, second).lines()]


def _goal(document: Document) -> str | None:
    return None if document.goal is None else value_text(document.goal)


def _header(first: Document, second: Document) -> Iterator[Marked]:
    for word, before, after in (
        ("world", first.world, second.world),
        ("goal", _goal(first), _goal(second)),
        ("main", first.main, second.main),
        ("include", _included(first), _included(second)),
    ):
        if before != after:
            yield Marked(CHANGED, 0, f"{word}: {before or 'none'} -> {after or 'none'}")
    for name in dict.fromkeys((*first.values, *second.values)):
        old, new = first.values.get(name), second.values.get(name)
        if old is not None and new is not None:
            if plain(old) != plain(new):
                yield Marked(CHANGED, 0, f"{name} = {value_text(old)} -> {value_text(new)}")
        elif old is not None:
            yield Marked(REMOVED, 0, f"{name} = {value_text(old)}")
        elif new is not None:
            yield Marked(ADDED, 0, f"{name} = {value_text(new)}")


def _included(document: Document) -> str:
    return ", ".join(include.path for include in document.includes)


class _Difference:
    def __init__(self, first: Document, second: Document) -> None:
        self.trees: tuple[Mapping[str, Tree], Mapping[str, Tree]] = first.trees, second.trees
        self.roots = units(first), units(second)
        matching = match(*self.roots)
        self.placed = {id(right): left for left, right in matching.placed}
        self.kept = {id(left) for left, _ in matching.placed}
        self.moved = {id(right): left for left, right in matching.moved}
        self.gone = {id(left) for left, _ in matching.moved}

    def lines(self) -> Iterator[Marked]:
        """Trees of the second in its order, then those that only the first has."""
        first, second = self.roots
        for name, root in second.items():
            if name not in first:
                yield Marked(ADDED, 0, heading(self.trees[1][name]))
                yield from self._units([(None, root, 1)])
                continue
            found = list(self._units(self._pairs([first[name]], [root], 1)))
            before, after = (_head(trees[name]) for trees in self.trees)
            mark, words = SAME, after
            if before != after:
                mark, words = CHANGED, f"{after}, was {before}"
            if mark != SAME or any(line.mark != SAME for line in found):
                yield Marked(mark, 0, words)
                yield from found
        for name, root in first.items():
            if name not in second:
                yield Marked(REMOVED, 0, heading(self.trees[0][name]))
                yield from self._units([(root, None, 1)])

    def _pairs(
        self, left: list[Unit], right: list[Unit], depth: int
    ) -> list[tuple[Unit | None, Unit | None, int]]:
        """Two lists of children as one: those of both, and in between those of one alone."""
        pairs: list[tuple[Unit | None, Unit | None, int]] = []
        rest = iter(left)
        for unit in right:
            before = self.placed.get(id(unit))
            if before is not None:
                for other in rest:
                    if other is before:
                        break
                    pairs.append((other, None, depth))
            pairs.append((before, unit, depth))
        return pairs + [(other, None, depth) for other in rest]

    def _units(self, pairs: list[tuple[Unit | None, Unit | None, int]]) -> Iterator[Marked]:
        stack = pairs[::-1]
        while stack:
            left, right, depth = stack.pop()
            if left is not None and right is not None:
                yield self._both(left, right, depth)
                if left.digest != right.digest:
                    stack += reversed(self._pairs(left.kids, right.kids, depth + 1))
            elif right is not None and id(right) in self.moved:
                was = self.moved[id(right)].node.place
                said = f"{_line(right)}  [moved, was in line {was.line}]"
                yield Marked(CHANGED, depth, said)
            elif right is not None:
                yield Marked(ADDED, depth, _line(right))
                stack += [(None, kid, depth + 1) for kid in reversed(right.kids)]
            elif left is not None and id(left) not in self.gone:
                yield Marked(REMOVED, depth, _line(left))
                stack += [(kid, None, depth + 1) for kid in reversed(left.kids)]

    def _both(self, left: Unit, right: Unit, depth: int) -> Marked:
        changes = list(_changes(left, right))
        if changes:
            return Marked(CHANGED, depth, f"{_line(right)}  [{'; '.join(changes)}]")
        more = " …" if right.kids and left.digest == right.digest else ""
        return Marked(SAME, depth, _line(right) + more)


def _line(unit: Unit) -> str:
    role = f"{unit.role}: " if unit.role else ""
    again = "".join(f"; {codes}: try again" for codes in unit.again)
    return role + text(unit.node, [*unit.around]) + again


def _head(tree: Tree) -> str:
    """A tree's name and ports, with everything in which two may differ."""
    words = heading(tree)
    for port in tree.ports.values():
        if port.default is not None:
            words += f", {port.name} is {value_text(port.default)} by default"
        if port.doc:
            words += f", {port.name}: {port.doc}"
    words += ", open" if tree.open else ""
    return words + (f" ({tree.doc})" if tree.doc else "")


def _changes(left: Unit, right: Unit) -> Iterator[str]:
    """The differences between two nodes themselves, in words."""
    old, new = left.node, right.node
    if left.role != right.role:
        yield f"was {left.role or 'a child'}"
    if title(old) != title(new):
        yield f"was {title(old)}"
    if old.note != new.note:
        yield f"note: {old.note or 'none'} -> {new.note or 'none'}"
    for name in dict.fromkeys((*old.ports, *new.ports)):
        before, after = old.ports.get(name), new.ports.get(name)
        if before is None and after is not None:
            yield f"+ {name} {value_text(after)}"
        elif after is None and before is not None:
            yield f"- {name} {value_text(before)}"
        elif before is not None and after is not None and plain(before) != plain(after):
            yield f"{name} {_arrow(before, after)}"
    before_it, after_it = _around(left), _around(right)
    for name in dict.fromkeys((*before_it, *after_it)):
        old_text, new_text = before_it.get(name), after_it.get(name)
        if old_text is None:
            yield f"+ {name} {new_text}".rstrip()
        elif new_text is None:
            yield f"- {name} {old_text}".rstrip()
        elif old_text != new_text:
            yield f"{name} {old_text} -> {new_text}"
    if list(before_it) != list(after_it) and sorted(before_it) == sorted(after_it):
        yield f"in this order: {', '.join(after_it)}"


def _arrow(before: PortValue, after: PortValue) -> str:
    """Two values; where they read alike, a text and a number differ by quotes."""
    shown = value_text(before), value_text(after)
    if shown[0] == shown[1]:
        shown = _quoted(before), _quoted(after)
    return f"{shown[0]} -> {shown[1]}"


def _quoted(value: PortValue) -> str:
    if isinstance(value, Literal):
        return json.dumps(value.value, ensure_ascii=False)
    return value_text(value)


def _around(unit: Unit) -> dict[str, str]:
    """Decorators, innermost first, conditions and words beside a node; each with its value."""
    found: dict[str, str] = {}
    for each in reversed(unit.around):
        name = title(each)
        while name in found:
            name += "'"
        ports = [each.ports[port] for port in sorted(each.ports)]
        found[name] = ", ".join([*map(value_text, ports), *([each.note] if each.note else [])])
    found |= dict(sorted(unit.node.conditions.items()))
    if unit.node.disabled:
        found["disabled"] = ""
    return found | {f"{codes}:": "try again" for codes in unit.again}
