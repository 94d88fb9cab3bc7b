"""Gather all data of the page; `assets/record.js` reads it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from momantu_bt.page.about import about
from momantu_bt.page.board import board
from momantu_bt.page.failures import failure_rows
from momantu_bt.page.floor import floor
from momantu_bt.page.lanes import lanes
from momantu_bt.page.statuses import FAILURE, IDLE, RUNNING, SKIPPED, STATUS_NUMBERS, shown
from momantu_bt.page.tables import Texts
from momantu_bt.record.recording import NodeInfo, Recording
from momantu_bt.record.text.lines import is_frame

_CAMERA = "/camera/"


def page_data(recording: Recording) -> dict[str, Any]:
    """The page's data. Ticks are indices into `times`, nodes and files are indices too."""
    changes = list(shown(recording))
    failures = failure_rows(recording)
    notes = Texts("")
    return {
        "about": about(recording),
        "times": [round(tick.now, 6) for tick in recording.ticks],
        "numbers": [tick.number for tick in recording.ticks],
        "end": sum(not tick.settling for tick in recording.ticks) - 1,
        "files": [{"name": n, "text": text} for n, text in recording.files.items()],
        "nodes": _nodes(recording),
        "changes": {
            "tick": [change.tick for change in changes],
            "node": [change.node for change in changes],
            "status": [STATUS_NUMBERS[change.status] for change in changes],
            "note": [notes.number(change.note) for change in changes],
        },
        "notes": notes.texts,
        "labels": _labels(recording),
        "failures": failures,
        "lanes": lanes(recording, failures),
        "cameras": _cameras(recording),
        "floor": floor(recording),
        **board(recording),
    }


def _labels(recording: Recording) -> dict[str, list[Any]]:
    """The lines of nodes over time; those that they begin with are at tick -1."""
    texts = Texts()
    rows = [(-1, node.index, node.label) for node in recording.nodes]
    rows += [(i, *each) for i, tick in enumerate(recording.ticks) for each in tick.labels]
    return {
        "tick": [tick for tick, _, _ in rows],
        "node": [node for _, node, _ in rows],
        "text": [texts.number(text) for _, _, text in rows],
        "texts": texts.texts,
    }


def _nodes(recording: Recording) -> dict[str, list[Any]]:
    """Columns by node.

    row, above: see `rows_above`. prefix: what it is for the node above, such as `try: `. again: the
    texts of its handlers that only try again. file: -1 where the record has it not.
    """
    places = [node.place.rpartition(":") for node in recording.nodes]
    runs, failures = _counts(recording)
    own, above = _rows_above(recording.nodes)
    return {
        "name": [node.name for node in recording.nodes],
        "type": [node.type for node in recording.nodes],
        "row": own,
        "above": above,
        "prefix": _prefixes(recording.nodes),
        "again": [
            [f"{prefix}try again" for prefix, is_node in node.plan if not is_node]
            for node in recording.nodes
        ],
        "file": [_file_number(file, list(recording.files)) for file, _, _ in places],
        "line": [int(line) if line.isdigit() else 0 for _, _, line in places],
        "runs": runs,
        "failures": failures,
    }


def _file_number(file: str, names: Sequence[str]) -> int:
    """The file of a place, which may be written with another way to the same name."""
    if file in names:
        return names.index(file)
    alike = [i for i, name in enumerate(names) if PurePath(name).name == PurePath(file).name]
    return alike[0] if len(alike) == 1 else -1


def _counts(recording: Recording) -> tuple[list[int], list[int]]:
    """How often each node started and failed, from the report if it is there, or else counted.

    The count misses a start that ends at once with the same status as the start before it.
    """
    told: Sequence[Mapping[str, Any]] = (recording.report or {}).get("nodes", ())
    if len(told) == len(recording.nodes):
        return [each["runs"] for each in told], [each["failures"] for each in told]
    runs: Counter[int] = Counter()
    failed: Counter[int] = Counter()
    running: set[int] = set()
    for change in (change for tick in recording.ticks for change in tick.changes):
        if change.status not in (IDLE, SKIPPED) and change.node not in running:
            runs[change.node] += 1
        if change.status == RUNNING:
            running.add(change.node)
        else:
            running.discard(change.node)
        failed[change.node] += change.status == FAILURE
    count = len(recording.nodes)
    return [runs[node] for node in range(count)], [failed[node] for node in range(count)]


def _cameras(recording: Recording) -> list[dict[str, Any]]:
    """Per camera: name, times (s) and images, each an address that holds the picture itself."""
    found = []
    for topic in recording.topics():
        if not topic.startswith(_CAMERA):
            continue
        times, images = [], []
        for time, message in recording.messages(topic):
            times.append(round(time, 4))
            images.append(f"data:image/{message['format']};base64,{message['data']}")
        found.append({"name": topic.removeprefix(_CAMERA), "times": times, "images": images})
    return found


def _prefixes(nodes: Sequence[NodeInfo]) -> list[str]:
    """What each node is for the one above it, as displays write it before its label."""
    prefixes = [""] * len(nodes)
    plans = [iter([prefix for prefix, is_node in node.plan if is_node]) for node in nodes]
    for node in nodes:
        if node.parent is not None:
            prefixes[node.index] = next(plans[node.parent], "")
    return prefixes


def _rows_above(nodes: Sequence[NodeInfo]) -> tuple[list[int], list[int]]:
    """By node: the node in whose row it is shown, and the one whose row is above that, or -1."""
    own: list[int] = []
    above: list[int] = []
    for node in nodes:
        if node.parent is None:
            own.append(node.index)
            above.append(-1)
            continue
        around = own[node.parent]
        framed = is_frame(node.role, nodes[node.parent].role)
        own.append(around if framed else node.index)
        above.append(above[around] if framed else around)
    return own, above
