"""What a row came to."""

from __future__ import annotations

from momantu_bt.bench.process import REPORT
from momantu_bt.bench.spec import Row
from momantu_bt.record.report import SUCCESS


def succeeded(row: Row) -> bool:
    """Whether the tree succeeded and no referee denies it, as `run`'s exit code 0 says."""
    return bool(row["ended"] == REPORT and row["status"] == SUCCESS and row["success"] is not False)
