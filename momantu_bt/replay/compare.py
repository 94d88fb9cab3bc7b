"""Comparing two recorded runs: where they part, and how they differ as a whole."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import unified_diff
from itertools import zip_longest
from pathlib import PurePath
from typing import Any

from momantu_bt.record.recording import NodeInfo, Recording
from momantu_bt.replay.difference import NOTHING, Difference, first_difference, node_words
from momantu_bt.replay.run_text import run_lines

_OUTCOME = ("status", "success", "failure", "unmet", "sim_time_s", "ticks", "error")
"""The parts of a report that say how a run ended. Wall times and folders do not count."""
_COUNTS = ("runs", "failures", "seconds")
_ABOUT = ("world", "robot", "seed")


@dataclass(frozen=True, slots=True)
class Parting:
    """The place where the printed lines of two runs begin to differ. Times do not count.

    before: the last line that both have, empty at the beginning. left, right: each run's next line.
    """

    before: str
    left: str
    right: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two runs compared. All fields but `first` and `parting` hold lines: name, left, right.

    first: the earliest difference. given: what the runs were made with (versions,
    options, values, seed). files: a unified diff for each text that differs, by name. outcome: how
    the runs ended. nodes: counts of nodes that differ.
    """

    first: Difference | None
    parting: Parting | None
    given: tuple[tuple[str, str, str], ...]
    files: Mapping[str, tuple[str, ...]]
    outcome: tuple[tuple[str, str, str], ...]
    nodes: tuple[tuple[str, str, str], ...]

    @property
    def equal(self) -> bool:
        """Whether the same happened in both runs. What they were made with does not count."""
        return self.first is None and not self.outcome

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        parting = self.parting
        return {
            "equal": self.equal,
            "first": None if self.first is None else self.first.as_dict(),
            "parting": None
            if parting is None
            else {"before": parting.before, "left": parting.left, "right": parting.right},
            "given": _lines_data(self.given),
            "files": {name: list(lines) for name, lines in self.files.items()},
            "outcome": _lines_data(self.outcome),
            "nodes": _lines_data(self.nodes),
        }


def _lines_data(lines: Sequence[tuple[str, str, str]]) -> list[dict[str, str]]:
    return [{"name": name, "left": left, "right": right} for name, left, right in lines]


def compare(left: Recording, right: Recording) -> Comparison:
    """Compare two records, whole or cut off."""
    return Comparison(
        first=_tree(left.nodes, right.nodes) or _first(left, right),
        parting=_parting(left, right),
        given=_unlike(_given(left), _given(right)),
        files=_files(left, right),
        outcome=_unlike(_outcome(left), _outcome(right)),
        nodes=_unlike(_counts(left), _counts(right)),
    )


def _tree(left: Sequence[NodeInfo], right: Sequence[NodeInfo]) -> Difference | None:
    """The first node that differs between the trees. If any does, ticks cannot be compared."""
    for number, (one, other) in enumerate(zip_longest(left, right)):
        if one is None or other is None or (one.name, one.type) != (other.name, other.type):
            words = [NOTHING if each is None else node_words(each) for each in (one, other)]
            return Difference(0, 0.0, "tree", f"node {number}", *words)
    return None


def _first(left: Recording, right: Recording) -> Difference | None:
    for one, other in zip(left.ticks, right.ticks, strict=False):
        found = first_difference(one, other, left.nodes, surroundings=True)
        if found is not None:
            return found
    counts = len(left.ticks), len(right.ticks)
    if counts[0] == counts[1]:
        return None
    longer = left if counts[0] > counts[1] else right
    tick = longer.ticks[min(counts)]
    goes_on, ends = "goes on", "has ended"
    words = (goes_on, ends) if longer is left else (ends, goes_on)
    return Difference(tick.number, tick.now, "end", "", *words)


def _parting(left: Recording, right: Recording) -> Parting | None:
    before = ""
    for one, other in zip_longest(run_lines(left), run_lines(right)):
        texts = [NOTHING if each is None else each[1].strip() for each in (one, other)]
        if _without_time(texts[0]) != _without_time(texts[1]):
            return Parting(before, texts[0], texts[1])
        before = texts[0]
    return None


def _without_time(line: str) -> str:
    """The line without its time."""
    return line.partition(" s ")[2] if line != NOTHING else line


def _given(recording: Recording) -> dict[str, str]:
    about = recording.about
    found = {name: str(about[name]) for name in _ABOUT}
    for group in ("options", "values", "versions"):
        found |= {f"{group[:-1]} {name}": str(value) for name, value in about[group].items()}
    return found


def _outcome(recording: Recording) -> dict[str, str]:
    report = recording.report
    if report is None:
        return {"end": "cut off"}
    found = {name: report[name] for name in _OUTCOME}
    failure = report["failure"]
    found["failure"] = None if failure is None else f"{failure['code']}, {failure['message']}"
    found["error"] = str(report["error"] or "").strip().rpartition("\n")[2]
    return {name: str(value) for name, value in found.items()}


def _counts(recording: Recording) -> dict[str, str]:
    """The counts of each node of a report, as `runs 2, failures 1, seconds 3.5`."""
    found: dict[str, str] = {}
    rows = () if recording.report is None else recording.report["nodes"]
    for info, row in zip(recording.nodes, rows, strict=False):
        counts = ", ".join(f"{name} {row[name]:g}" for name in _COUNTS)
        found[f"{info.index} {node_words(info)}"] = counts
    return found


def _unlike(left: Mapping[str, str], right: Mapping[str, str]) -> tuple[tuple[str, str, str], ...]:
    names = dict.fromkeys((*left, *right))
    pairs = ((name, left.get(name, NOTHING), right.get(name, NOTHING)) for name in names)
    return tuple(pair for pair in pairs if pair[1] != pair[2])


def _files(left: Recording, right: Recording) -> Mapping[str, tuple[str, ...]]:
    """Texts by their names. The two trees are compared even if their files have other names."""
    ours, theirs = _texts(left), _texts(right)
    found = {}
    for name in dict.fromkeys((*ours, *theirs)):
        texts = ours.get(name, ""), theirs.get(name, "")
        if texts[0] != texts[1]:
            lines = [text.splitlines() for text in texts]
            diff = unified_diff(lines[0], lines[1], "left", "right", n=1, lineterm="")
            found[name] = tuple(diff)
    return found


def _texts(recording: Recording) -> dict[str, str]:
    """All options but values. Values are compared one by one."""
    tree, kinds = recording.about["tree"], recording.kinds
    return {
        "the tree" if name == tree else name: _readable(text) if kinds[name] == "site" else text
        for name, text in recording.files.items()
        if kinds[name] != "values"
    }


def _readable(site: str) -> str:
    """A site on many lines, without the folders of its files."""

    def without_folder(data: dict[str, Any]) -> dict[str, Any]:
        return {"$path": PurePath(data["$path"]).name} if "$path" in data else data

    return json.dumps(json.loads(site, object_hook=without_folder), indent=1)
