"""The lanes of the timeline: what skills did when, and what went wrong."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from momantu_bt.page.bars import Bar, bars
from momantu_bt.page.statuses import FAILURE, IDLE, RUNNING, STATUS_NUMBERS, SUCCESS
from momantu_bt.record.recording import Recording
from momantu_bt.tree.catalogue import NODES

_ENDED = {SUCCESS: "succeeded", IDLE: "was stopped", RUNNING: "still runs at the end"}


def lanes(recording: Recording, failures: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A lane for each skill, in the order in which they first ran, then what went wrong.

    A built-in leaf has a lane when it ran for longer than a tick.
    """
    kinds: dict[str, list[Bar]] = {}
    for bar in bars(recording):
        kinds.setdefault(recording.nodes[bar.node].type, []).append(bar)
    found = [
        {"name": _spelled(kind), "kind": "skill", "bars": [_row(recording, bar) for bar in same]}
        for kind, same in kinds.items()
        if kind not in NODES or any(bar.end > bar.begin for bar in same)
    ]
    told = {
        "failures": [_failure(failure) for failure in failures],
        "incidents": list(_incidents(recording)),
        "denied claims": list(_lies(recording)),
        "faults": list(_faults(recording)),
    }
    said = list(_logs(recording))
    found += [{"name": "log", "kind": "marks", "bars": said}] if said else []
    return found + [
        {"name": name, "kind": "faults" if name == "faults" else "marks", "bars": marks}
        for name, marks in told.items()
        if marks
    ]


def _spelled(kind: str) -> str:
    return NODES[kind].yaml[0] if kind in NODES else kind


def _row(recording: Recording, bar: Bar) -> dict[str, Any]:
    begin, end = (recording.ticks[i].now for i in (bar.begin, bar.end))
    ending = f"failed: {bar.failure}" if bar.failure else _ENDED.get(bar.status, "failed")
    words = (
        f"{bar.label} ({recording.nodes[bar.node].place})",
        f"{begin:.2f} s to {end:.2f} s ({end - begin:.2f} s)",
        ", ".join(dict.fromkeys(bar.notes)),
        ending,
    )
    return {
        "begin": bar.begin,
        "end": bar.end,
        "status": STATUS_NUMBERS[bar.status],
        "words": "\n".join(filter(None, words)),
    }


def _logs(recording: Recording) -> Iterator[dict[str, Any]]:
    """What skills logged, a mark for each tick."""
    for tick, record in enumerate(recording.ticks):
        lines = [f"{recording.nodes[node].name}: {text}" for node, text in record.logs]
        if lines:
            words = "\n".join([f"{record.now:.2f} s", *lines])
            yield _mark(tick, words) | {"status": STATUS_NUMBERS[RUNNING]}


def _failure(failure: Mapping[str, Any]) -> dict[str, Any]:
    link = failure["links"][0]
    words = f"{link['node']} {link['place']} failed: {link['code']}, {link['message']}"
    return _mark(failure["tick"], words)


def _mark(tick: int, words: str) -> dict[str, Any]:
    return {"begin": tick, "end": tick, "status": STATUS_NUMBERS[FAILURE], "words": words}


def _incidents(recording: Recording) -> Iterator[dict[str, Any]]:
    """The incidents that the referee saw."""
    for incident in (recording.report or {}).get("incidents", ()):
        words = f"{incident['kind']}: {incident['sentence']}"
        yield _mark(_tick_at(recording, incident["time"]), words)


def _lies(recording: Recording) -> Iterator[dict[str, Any]]:
    """Ends of skills that ground truth contradicts."""
    claims = (recording.report or {}).get("claims") or {}
    for skill, counted in claims.items():
        for lie in counted["lies"]:
            words = (
                f"{skill} ({lie['place']}): {lie['code'] or 'SUCCESS'}, but not so: {lie['claim']}"
            )
            yield _mark(_tick_at(recording, lie["time"]), words)


def _faults(recording: Recording) -> Iterator[dict[str, Any]]:
    """Faults that were made on purpose and have begun; one without an end lasted to the end."""
    for fault in (recording.report or {}).get("faults", ()):
        began, ended = fault["began"], fault["ended"]
        if began is not None and recording.ticks:
            last = len(recording.ticks) - 1
            yield {
                "begin": _tick_at(recording, began),
                "end": last if ended is None else _tick_at(recording, ended),
                "status": STATUS_NUMBERS[IDLE],
                "words": f"{fault['fault']}\nfrom {began:.2f} s on",
            }


def _tick_at(recording: Recording, time: float) -> int:
    """The last tick that is not after a time."""
    found = bisect_right(recording.ticks, time + 1e-6, key=lambda tick: tick.now)
    return max(0, found - 1)
