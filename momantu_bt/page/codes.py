"""Statuses as a record writes them, and their numbers in the page's data.

`record.js` has the same numbers.
"""

from __future__ import annotations

from momantu_bt.engine.status import Status

IDLE, RUNNING, SUCCESS, FAILURE, SKIPPED = (status.value for status in Status)
STATUS_NUMBERS = {status.value: number for number, status in enumerate(Status)}
