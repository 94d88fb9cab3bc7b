"""Print coverage as text: the tree file with the number of runs beside each line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from momantu_bt.bench.statistics.coverage import GUARD, HANDLER, NODE, Point

MARK = "!"
"""Marks a line with something that never happened."""
_WORDS = {
    NODE: "nodes ran",
    HANDLER: "handlers answered",
    GUARD: "guards decided both ways",
}


def coverage_text(points: Sequence[Point], source: Mapping[str, str]) -> str:
    """Each file with marks, and a line of figures before it. source: texts by file."""
    parts = []
    for file, text in source.items():
        here = [point for point in points if point.place.file == file]
        if here:
            parts.append("\n".join([f"{file}: {_figures(here)}", *_marked(here, text)]))
    return "\n\n".join(parts)


def _figures(points: Sequence[Point]) -> str:
    """`41 of 62 nodes ran, 9 of 21 handlers answered`."""
    found = []
    for kind, words in _WORDS.items():
        mine = [point for point in points if point.kind == kind]
        if mine:
            found.append(f"{sum(point.covered for point in mine)} of {len(mine)} {words}")
    return ", ".join(found)


def _marked(points: Sequence[Point], text: str) -> list[str]:
    """The file's lines behind their counts."""
    by_line: dict[int, list[Point]] = {}
    for point in points:
        by_line.setdefault(point.place.line, []).append(point)
    lines = text.splitlines()
    said = {number: _said(by_line[number]) for number in by_line}
    width = max(map(len, said.values()))
    digits = len(str(len(lines)))
    found = []
    for number, line in enumerate(lines, 1):
        here = by_line.get(number, ())
        mark = " " if all(point.covered for point in here) else MARK
        counts = said.get(number, "")
        found.append(f"{mark} {counts:>{width}} {number:{digits}} | {line}".rstrip())
    return found


def _said(points: Sequence[Point]) -> str:
    """`500`; `0-500` where one line holds several; `3 of 500` of a guard."""
    counts = sorted(point.count for point in points if point.kind != GUARD)
    words = []
    if counts:
        alike = counts[0] == counts[-1]
        words.append(str(counts[0]) if alike else f"{counts[0]}-{counts[-1]}")
    words += [f"{point.count} of {point.asked}" for point in points if point.kind == GUARD]
    return ", ".join(words)
