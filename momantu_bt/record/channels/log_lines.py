"""Failures, remarks and what skills log, for a reader: `/log`."""

from __future__ import annotations

from momantu_bt.engine.executor import Executor
from momantu_bt.engine.status import FAILURE
from momantu_bt.failure import FailureValue
from momantu_bt.record.channels.channel import stamp_of, time_text
from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.viewer_schemas import LOG

_INFO, _WARNING = 2, 3
"""foxglove.LogLevel."""


class LogLines:
    """Writes each new failure of a leaf, each line of a skill, and each remark.

    remarks: `write` empties it.
    """

    def __init__(self, file: McapFile, remarks: list[str]) -> None:
        self._channel = file.channel("/log", "foxglove.Log", LOG)
        self._remarks = remarks
        self._said: dict[int, FailureValue] = {}

    def write(self, run: Executor, file: McapFile) -> None:
        """The messages since the last tick."""
        now = run.context.now
        for text in self._remarks:
            self._line(file, now, _WARNING, text, "momantu-bt", "")
        self._remarks.clear()
        for leaf, text in run.context.logs:
            self._line(file, now, _INFO, text, leaf.name, leaf.place)
        for node, status, _, failure in run.context.changes:
            if status is not FAILURE or failure is None or node.kids:
                continue
            if self._said.get(node.index) is not failure:
                self._said[node.index] = failure
                self._line(file, now, _INFO, str(failure), node.name, node.place)

    def _line(
        self, file: McapFile, now: float, level: int, text: str, name: str, place: str
    ) -> None:
        where, _, line = place.rpartition(":")
        number = int(line) if line.isdigit() else 0
        file.add(
            self._channel,
            stamp_of(now),
            f'{{"timestamp":{time_text(now)},"level":{level},"message":{dumps(text)},'
            f'"name":{dumps(name)},"file":{dumps(where)},"line":{number}}}',
        )
