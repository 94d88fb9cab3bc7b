"""The layout of a picture: an outline, one row for each box, wires in lanes beside it.

A box stands right of its parent and below it, so that no line from a box to the lanes on the right
crosses another box. Lengths in pixels, y downwards.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from momantu_bt.drawing.boxes import WIDEST, Box, Thread, TreePicture, cut, width_of

CELL = 7.3
"""Width of a character; the SVG stretches each text to exactly this width."""
SMALL_CELL = 6.1
LINE = 16.0
PAD = 7.0
INDENT = 26.0
GAP = 10.0
MARGIN = 16.0
TITLE = 26.0
PLUG = 14.0
"""Distance between two wires that end at one box."""
LANE = 12.0


@dataclass(frozen=True, slots=True)
class Placed:
    """A box with its rectangle. lines: the text in it. role: lines of text above it."""

    box: Box
    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]
    role: tuple[str, ...]

    @property
    def right(self) -> float:
        """X of its right edge."""
        return self.x + self.width


@dataclass(frozen=True, slots=True)
class Plug:
    """The point where a wire meets a box's right edge. writes: the wire begins here."""

    number: int
    x: float
    y: float
    writes: bool


@dataclass(frozen=True, slots=True)
class Lane:
    """One wire: a vertical line at x, and the ports connected to it."""

    key: str
    x: float
    plugs: tuple[Plug, ...]


@dataclass(frozen=True, slots=True)
class Outline:
    """One tree. y: the position of its title."""

    tree: TreePicture
    y: float
    boxes: tuple[Placed, ...]
    lanes: tuple[Lane, ...]
    width: float
    height: float


def outlines(trees: Sequence[TreePicture], *, wires: bool = True) -> list[Outline]:
    """The trees below each other."""
    made: list[Outline] = []
    top = MARGIN
    for tree in trees:
        outline = _outline(tree, top, wires)
        made.append(outline)
        top += outline.height + 2 * MARGIN
    return made


def _outline(tree: TreePicture, top: float, wires: bool) -> Outline:
    keys = _by_key(tree.threads) if wires else {}
    plugs = Counter(number for ends in keys.values() for number in ends)
    placed: list[Placed] = []
    y = top + TITLE
    for box in tree.boxes:
        lines = (box.title, *wrapped(box.lines, ", "))
        role = wrapped(box.role.split())
        y += LINE * len(role)
        height = max(LINE * len(lines) + PAD, PLUG * plugs[box.number] + PAD)
        width = max(map(width_of, lines)) * CELL + 2 * PAD
        placed.append(Placed(box, MARGIN + box.depth * INDENT, y, width, height, lines, role))
        y += height + GAP
    lanes = _lanes(placed, keys)
    ends = [each.right for each in placed] + [lane.x for lane in lanes]
    ends += [MARGIN + width_of(tree.title) * CELL]
    ends += [each.x + width_of(line) * SMALL_CELL for each in placed for line in each.role]
    return Outline(tree, top, tuple(placed), lanes, max(ends) + MARGIN, y - top)


def _by_key(threads: Sequence[Thread]) -> dict[str, dict[int, bool]]:
    """By key: the boxes that it joins, and whether each writes it."""
    keys: dict[str, dict[int, bool]] = {}
    for thread in threads:
        ends = keys.setdefault(thread.key, {})
        ends[thread.writer] = True
        ends.setdefault(thread.reader, False)
    return keys


def _lanes(placed: Sequence[Placed], keys: dict[str, dict[int, bool]]) -> tuple[Lane, ...]:
    """Each wire's plugs, and a lane in which it meets no other wire."""
    used: dict[int, int] = {}
    where = {each.box.number: each for each in placed}
    plugged: list[tuple[str, list[Plug]]] = []
    for key, joined in keys.items():
        plugs: list[Plug] = []
        for number, writes in sorted(joined.items()):
            box = where[number]
            used[number] = used.get(number, 0) + 1
            y = box.y + PAD / 2 + PLUG * (used[number] - 0.5)
            plugs.append(Plug(number, box.right, y, writes))
        plugged.append((key, plugs))
    ends = (plug.x + width_of(key) * SMALL_CELL for key, plugs in plugged for plug in plugs)
    first = max(ends, default=0.0)
    taken: list[list[tuple[float, float]]] = []
    lanes: list[Lane] = []
    # short ones go inside, where they cross fewer others
    for key, plugs in sorted(plugged, key=lambda item: item[1][-1].y - item[1][0].y):
        top, bottom = plugs[0].y, plugs[-1].y
        index = next(
            (i for i, spans in enumerate(taken) if all(top > b or bottom < t for t, b in spans)),
            len(taken),
        )
        if index == len(taken):
            taken.append([])
        taken[index].append((top, bottom))
        lanes.append(Lane(key, first + LANE * (index + 2), tuple(plugs)))
    return tuple(lanes)


def wrapped(texts: Sequence[str], between: str = " ") -> tuple[str, ...]:
    """Texts one after the other, in as few lines as they fit in."""
    lines: list[str] = []
    for text in map(cut, texts):
        if lines and width_of(lines[-1]) + len(between) + width_of(text) <= WIDEST:
            lines[-1] += between + text
        else:
            lines.append(text)
    return tuple(lines)
