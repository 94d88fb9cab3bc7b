"""The lines of a tree that fit into a display: what runs, what has failed, and what is near it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from momantu_bt.world import TreeLine

_FOLDED = {
    "RUNNING": "running",
    "FAILURE": "failed",
    "SUCCESS": "done",
    "SKIPPED": "skipped",
    "IDLE": "not begun",
}
_FIRST = ("RUNNING", "FAILURE", "IDLE", "SUCCESS")
"""Which lines stay rather than others that are as near."""


def fitted(lines: Sequence[TreeLine], room: int) -> list[TreeLine]:
    """At most `room` lines; a line such as `… 3 done, 2 not begun` stands for those left out.

    The running node that is deepest stays, then the nodes around it, then what is near it.
    """
    if len(lines) <= room:
        return list(lines)
    order = _by_nearness(lines)
    for count in range(room, 0, -1):
        found = list(_with_gaps(lines, set(order[:count])))
        if len(found) <= room:
            return found
    return [lines[i] for i in sorted(order[: max(0, room)])]


def _by_nearness(lines: Sequence[TreeLine]) -> list[int]:
    """The lines' indices, those first that matter most."""
    running = [i for i, line in enumerate(lines) if line.status == "RUNNING"]
    focus = max(running, key=lambda i: lines[i].depth, default=0)
    path = {i: lines[i].depth for i in _path(lines, focus)}
    above = [path.get(i, 0) for i in range(len(lines))]
    for i, line in enumerate(lines):  # where each line hangs on the way to the focus
        if i not in path:
            above[i] = min([line.depth - 1, lines[focus].depth, *_hung(lines, i, path)])

    def cost(i: int) -> tuple[int, ...]:
        line, deep = lines[i], lines[focus].depth
        if i in path:
            return 0, deep - line.depth
        rank = _FIRST.index(line.status) if line.status in _FIRST else len(_FIRST)
        return 1, deep - above[i] + (line.depth - above[i] - 1), rank, abs(i - focus)

    return sorted(range(len(lines)), key=cost)


def _path(lines: Sequence[TreeLine], focus: int) -> Iterator[int]:
    """A line and those above it in the tree."""
    depth = lines[focus].depth + 1
    for i in range(focus, -1, -1):
        if lines[i].depth < depth:
            depth = lines[i].depth
            yield i


def _hung(lines: Sequence[TreeLine], at: int, path: dict[int, int]) -> list[int]:
    """The depth of the nearest line above this one that is on the path."""
    return [path[i] for i in _path(lines, at) if i in path][:1]


def _with_gaps(lines: Sequence[TreeLine], kept: set[int]) -> Iterator[TreeLine]:
    gap: list[TreeLine] = []
    for i, line in enumerate(lines):
        if i not in kept:
            gap.append(line)
            continue
        yield from _gap(gap)
        gap = []
        yield line
    yield from _gap(gap)


def _gap(gap: Sequence[TreeLine]) -> Iterator[TreeLine]:
    """The line for those left out."""
    if len(gap) == 1:
        yield gap[0]
    elif gap:
        depth = min(line.depth for line in gap)
        counts = Counter(line.status for line in gap)
        words = [f"{counts[status]} {word}" for status, word in _FOLDED.items() if counts[status]]
        yield TreeLine(depth, f"… {', '.join(words)}", "IDLE")
