"""The report of a bench as JSON: its figures, its tables, and a row for each episode."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from momantu_bt.bench.rows.spec import Row
from momantu_bt.bench.statistics.summary import Summary
from momantu_bt.formats.files import write_whole

_TOO_LONG = ("nodes", "made_of")
"""Fields of rows that a report leaves to `results.jsonl`, or gives only once."""


def report(rows: Sequence[Row], more: Mapping[str, Any]) -> dict[str, Any]:
    """`episodes`, `successes`, `interval`, the other figures, `more`, and `rows` at the end."""
    made_of = rows[0]["made_of"] if rows else {}
    plain = [{k: v for k, v in row.items() if k not in _TOO_LONG} for row in rows]
    return {**Summary.of(rows).as_dict(), **more, "made_of": made_of, "rows": plain}


def write_report(path: Path, data: Mapping[str, Any]) -> None:
    """Write it whole or not at all; OutputError when that is not possible."""
    write_whole(path, json.dumps(data, indent=2, default=str) + "\n")
