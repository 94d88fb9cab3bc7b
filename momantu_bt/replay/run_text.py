"""A record as lines: what its run printed, and how it ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import Any

from momantu_bt.engine.status import Status
from momantu_bt.failure import FailureValue
from momantu_bt.record.recording import Recording
from momantu_bt.record.report import Report
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.record.text.ending import ending_text
from momantu_bt.replay.moment import ShownNode
from momantu_bt.world import Demanded


def headline(recording: Recording) -> str:
    """`my_tree, seed 3, world my_flat, robot my_robot; momantu-bt 0.1.0`."""
    about = recording.about
    words = [PurePath(about["tree"]).stem, f"seed {about['seed']}"]
    words += [f"{what} {about[what]}" for what in ("world", "robot") if about[what] is not None]
    version = about["versions"].get("momantu-bt", "of an unknown version")
    return f"{', '.join(words)}; momantu-bt {version}"


def run_lines(recording: Recording) -> Iterator[tuple[int, str]]:
    """Every line that the run printed, with the index of its tick."""
    nodes: list[ShownNode] = []
    for info in recording.nodes:
        above = None if info.parent is None else nodes[info.parent]
        nodes.append(ShownNode(info, info.label, above=above))
    said: list[str] = []
    lines = ChangeLines(said.append)
    for index, tick in enumerate(recording.ticks):
        for node, label in tick.labels:
            nodes[node].label = label
        lines.print_changes(
            tick.now,
            [(nodes[c.node], Status(c.status), c.note, c.failure) for c in tick.changes],
            [(nodes[node], text) for node, text in tick.logs],
        )
        yield from ((index, line) for line in said)
        said.clear()


def ending(recording: Recording) -> str:
    """How the run ended, in one line. If the record was cut off, say where."""
    data = recording.report
    if data is None:
        last = recording.ticks[-1].now if recording.ticks else 0.0
        return (
            f"the record ends here, {last:.2f} s after the run began: the run was killed, or "
            "still goes on"
        )
    return ending_text(report_of(data))


def report_of(data: Mapping[str, Any]) -> Report:
    """As much of a record's report as its last line needs."""
    return Report(
        tree=data["tree"],
        world=data["world"],
        robot=data["robot"],
        seed=data["seed"],
        status=data["status"],
        success=data["success"],
        failure=_failure(data["failure"]),
        unmet=tuple(data["unmet"]),
        measures={},
        sim_time_s=data["sim_time_s"],
        wall_time_s=data["wall_time_s"],
        start_time_s=data["start_time_s"],
        ticks=data["ticks"],
        blackboard={},
        nodes=(),
        fingerprint=data["fingerprint"],
        error=data["error"],
        demands=tuple(
            Demanded(d["demand"], d["place"], d["met"], tuple(d["unmet"]))
            for d in data.get("demands", ())
        ),
        interrupted_by=data.get("interrupted_by"),
    )


def _failure(data: Mapping[str, Any] | None) -> FailureValue | None:
    """A failure as `FailureValue.as_dict` gives it. A loop reads its causes, without recursion."""
    links: list[Mapping[str, Any]] = []
    while data is not None:
        links.append(data)
        data = data["cause"]
    value: FailureValue | None = None
    for link in reversed(links):
        value = FailureValue(
            link["code"],
            link["message"],
            link["data"],
            link["node"],
            link["place"],
            value,
            tries=link["tries"],
            most_tries=link["most_tries"],
        )
    return value
