"""Recording a run: an observer that writes `run.mcap` while the run lasts.

The recorder does not change the run. On an error, such as a full disk, it publishes one remark and
stops; the run continues, and the part that was written stays readable.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from momantu_bt.engine.context import Remarked
from momantu_bt.engine.events import Events
from momantu_bt.engine.executor import Executor, Ticked
from momantu_bt.formats.files import OutputError, write_whole
from momantu_bt.formats.maps import read_map
from momantu_bt.record.about import files_of, nodes_data, run_data
from momantu_bt.record.channels.channel import Channel, stamp_of
from momantu_bt.record.channels.floor_plan import grid_text
from momantu_bt.record.channels.log_lines import LogLines
from momantu_bt.record.channels.markers import Markers
from momantu_bt.record.channels.objects import Objects
from momantu_bt.record.channels.poses import Poses
from momantu_bt.record.channels.published import Published
from momantu_bt.record.channels.sensors import Sensors
from momantu_bt.record.channels.ticks import Ticks
from momantu_bt.record.codec import dumps
from momantu_bt.record.folder import LOG, REPORT, prepare_folder
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.schemas import END, FILE, NODES, RUN, Schema
from momantu_bt.record.mcap.viewer_schemas import GRID
from momantu_bt.record.outside_log import OutsideLog
from momantu_bt.record.report import Report
from momantu_bt.tree.model import Document

MOST_TICKS, MOST_SECONDS = 10, 0.1
"""A crash loses at most this many unchanged ticks, or this much wall time (s)."""


class Recorder:
    """Writes one record. It subscribes to the run's events; call `begin`, and `finish` at the end.

    remark: called with a message for a person if the record cannot be written.
    broken: it could not be written to its end.

    Raises:
        OutputError: the folder cannot be written, or holds a record already.
    """

    def __init__(self, folder: Path, events: Events, remark: Callable[[str], None]) -> None:
        prepare_folder(folder)
        self._folder = folder.absolute()  # a skill may change the working directory
        self._remark = remark
        self._file: McapFile | None = None
        self.broken = False
        self._stamp = 0
        self._flushed = time.monotonic()
        self._outside = OutsideLog(events)
        self._sensors = Sensors(events)
        self._markers = Markers(events)
        self._remarks: list[str] = []
        events.subscribe(Remarked, lambda event: self._remarks.append(event.text))
        self._ticks: Ticks | None = None
        self._others: Sequence[Channel] = ()

    def begin(
        self,
        document: Document,
        run: Executor,
        options: Mapping[str, Any],
        substitution: Mapping[str, str],
    ) -> None:
        """Write the start of the record: the run, its files, its nodes and the initial values.

        options, substitution: as in `run_data` and `files_of`.
        """
        self._guarded(self._open, document, run, options, substitution)
        run.context.events.subscribe(Ticked, lambda event: self._ticked(event.run))

    def _ticked(self, run: Executor) -> None:
        """Write the tick; flush the file if anything changed or the last flush is too old."""
        self._guarded(self._write, run)

    def finish(self, report: Report) -> None:
        """Write the report into the log, and as a separate file."""
        text = json.dumps(report.as_dict(), default=str)
        self._guarded(self._end, text)
        try:
            write_whole(self._folder / REPORT, text + "\n")
        except OutputError as error:
            self.broken = True
            self._remark(f"the record has no report: {error}")

    def release(self) -> None:
        """Close the log of a run without a report; remove the log if the run never began."""
        if self._file is not None:
            self._guarded(self._file.close)
        elif not self.broken:
            (self._folder / LOG).unlink(missing_ok=True)

    def _guarded(self, work: Callable[..., None], *arguments: Any) -> None:
        """Call `work`, unless an earlier call failed; the first failure ends the record."""
        if self.broken:
            return
        try:
            work(*arguments)
        except Exception as error:
            self.broken = True
            why = (isinstance(error, OSError) and error.strerror) or repr(error)
            self._remark(f"the record {self._folder} breaks off here: {why}; the run goes on")
            if self._file is not None:
                self._file.abandon()

    def _open(
        self,
        document: Document,
        run: Executor,
        options: Mapping[str, Any],
        substitution: Mapping[str, str],
    ) -> None:
        file = self._file = McapFile(self._folder / LOG)
        _add(file, "/run", "momantu.Run", RUN, run_data(document, options, run))
        for text in files_of(document, substitution, run):
            _add(file, "/files", "momantu.File", FILE, text)
        _add(file, "/nodes", "momantu.Nodes", NODES, nodes_data(run))
        self._ticks = Ticks(file, self._outside, run)
        self._ticks.write(run, file)
        others: list[Channel] = [LogLines(file, self._remarks)]
        body = run.context.body
        if body is not None:
            others += [Poses(file, body), Published(run.context.remark), Objects(file)]
            others += [self._sensors, self._markers]
            self._write_map(file, body.site.map_file, run.context.remark)
        self._others = others
        file.flush()

    def _write_map(
        self, file: McapFile, map_file: Path | None, remark: Callable[[str], None]
    ) -> None:
        if map_file is None:
            return
        try:
            text = grid_text(read_map(map_file))
        except ValueError as error:
            remark(f"the record has no map: {error}")
            return
        file.add(file.channel("/map", "foxglove.Grid", GRID), 0, text)

    def _write(self, run: Executor) -> None:
        file, ticks = self._file, self._ticks
        assert file is not None
        assert ticks is not None
        ticks.write(run, file)
        for channel in self._others:
            channel.write(run, file)
        self._stamp = stamp_of(run.context.now)
        if run.context.changes or run.context.tick % MOST_TICKS == 0 or self._late():
            file.flush()

    def _late(self) -> bool:
        now = time.monotonic()
        late = now - self._flushed > MOST_SECONDS
        if late:
            self._flushed = now
        return late

    def _end(self, text: str) -> None:
        file = self._file
        assert file is not None
        if file.removed:
            raise FileNotFoundError(0, "somebody has deleted it")
        file.add(file.channel("/end", "momantu.End", END), self._stamp, text)
        file.finish()


def _add(file: McapFile, topic: str, name: str, schema: Schema, data: Any) -> None:
    file.add(file.channel(topic, name, schema), 0, dumps(data))
