"""Open a record that the command line names."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.cli.shared.notices import notice
from momantu_bt.record.reader import RecordError, read_record
from momantu_bt.record.recording import Recording


def open_record(folder: Path) -> Recording:
    """The record in a folder; prints a notice when it was cut off.

    Raises:
        RecordError: no record can be read, or it ends before the first tick.
    """
    recording = read_record(folder)
    if not recording.ticks or not recording.nodes:
        raise RecordError(f"{folder}: the record ends before the first tick")
    if not recording.complete:
        last = recording.ticks[-1].now
        notice(f"{folder}: the record was cut off after {last:.2f} s; it is read up to there")
    return recording
