"""Counting answers, and fitting what each sense is worth."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any

from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.hand import evidence
from momantu_skills.manipulation.scene.payload import OPEN

from holding.hand import ROBOTS


def told(rows: Sequence[dict[str, Any]]) -> str:
    """A table: each kind of state, and how often the answer was right, false or missing."""
    table: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        verdict = _verdict(row)
        for key in (row["kind"], "all"):
            table[key][verdict] += 1
    words = ("right", "false HOLDING", "false NOT_HOLDING", "unknown", "neither")
    lines = [f"{'':24}" + "".join(f"{word:>19}" for word in words)]
    for kind, counts in table.items():
        if kind != "all":
            lines.append(f"{kind:24}" + "".join(f"{counts[word]:19}" for word in words))
    return "\n".join([*lines, f"{'all':24}" + "".join(f"{table['all'][w]:19}" for w in words)])


def fitted(rows: Sequence[dict[str, Any]]) -> str:
    """What each sense is worth: shares of readings, with something in the hand and with nothing.

    Every kind of state counts alike. A share is (k + 1/2) / (n + m/2) of k in n states for one of m
    readings (Krichevsky and Trofimov 1981), so that none is 0. LEANING and HANGING are the
    shares of states with a weight below or above that of what is held by four standard deviations.
    """
    rows = [row for row in rows if row["truth"] is not None]
    lines = [f"{'':12}{'held':>8}{'empty':>8}   log odds"]
    for words, reading in ((FINGERS, _fingers), (PICTURES, _picture)):
        counts = {truth: Counter[str]() for truth in (True, False)}
        for row in rows:
            counts[row["truth"]][reading(row)] += 1
        for word in words:
            h, e = (
                (counts[t][word] + 0.5) / (counts[t].total() + len(words) / 2)
                for t in (True, False)
            )
            lines.append(f"{word:12}{h:8.3f}{e:8.3f}{math.log(h / e):9.2f}")
    weighed = [row for row in rows if "weight" in row]
    for truth, way, name in ((True, -1, "leaning"), (False, -1, "leaning"), (False, 1, "hanging")):
        mine = [row for row in weighed if row["truth"] is truth]
        off = [row for row in mine if way * (row["weight"] - row["held"]) > 4.0 * _sigma(row)]
        share = (len(off) + 0.5) / (len(mine) + 1.0)
        lines.append(f"{name:12}{share:8.3f}   {'held' if truth else 'empty'}, {len(mine)} states")
    return "\n".join(lines)


FINGERS = ("shut", "opened", "free", "pressing")
PICTURES = ("seen", "through", "neither")


def _fingers(row: dict[str, Any]) -> str:
    config, widest = SceneConfig(), ROBOTS[row["robot"]]().hand.max_width
    if row["width"] < config.closed_width:
        return "shut"
    if row["effort"] >= config.least_effort:
        return "pressing"
    return "opened" if row["width"] > OPEN * widest else "free"


def _picture(row: dict[str, Any]) -> str:
    if row.get("points", 0) >= evidence.SOME:
        return "seen"
    return "through" if row.get("through", 0.0) >= evidence.EMPTY_FROM else "neither"


def _sigma(row: dict[str, Any]) -> float:
    return math.hypot(row["noise"], row["shared"])


def _verdict(row: dict[str, Any]) -> str:
    if row["truth"] is None:
        return "neither"
    if row["answer"] not in ("HOLDING", "NOT_HOLDING"):
        return "unknown"
    if (row["answer"] == "HOLDING") is row["truth"]:
        return "right"
    return f"false {row['answer']}"
