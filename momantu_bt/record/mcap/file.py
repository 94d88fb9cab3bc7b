"""A run's MCAP file while it is written: safe against a crash after each tick.

Messages are JSON. The file holds them one by one, not in chunks. The messages of a tick go to the
operating system in one piece, so they can be read whatever ends the process afterwards.
"""

from __future__ import annotations

import os
import struct
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap.records import (
    CHANNEL,
    MAGIC,
    SCHEMA,
    STATISTICS,
    channel_record,
    data_end_record,
    footer_record,
    header_record,
    offset_record,
    schema_record,
    statistics_record,
)

_MESSAGE = struct.Struct("<BQHIQQ").pack
_MESSAGE_CODE, _MESSAGE_HEAD = 0x05, 2 + 4 + 8 + 8
"""The opcode, and the bytes before the data: channel, sequence, log time and publish time."""


class McapFile:
    """Channels by topic, and their messages. All methods may raise OSError: then `abandon` it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._raw = path.open("wb", buffering=0)
        self._whole = 0
        self._pending: list[bytes] = [MAGIC, header_record()]
        self._channels: dict[str, tuple[int, bytes]] = {}
        self._schemas: dict[str, tuple[int, bytes]] = {}
        self._counts: Counter[int] = Counter()
        self._sequence = 0
        self._last = 0

    def channel(self, topic: str, name: str, schema: Mapping[str, Any]) -> int:
        """The number of a topic's channel; the first use makes it and its schema."""
        known = self._channels.get(topic)
        if known is None:
            number, form = len(self._channels) + 1, self._schema(name, schema)
            known = (number, channel_record(number, form, topic))
            self._channels[topic] = known
            self._pending.append(known[1])
        return known[0]

    def _schema(self, name: str, schema: Mapping[str, Any]) -> int:
        known = self._schemas.get(name)
        if known is None:
            number, text = len(self._schemas) + 1, dumps({"title": name, **schema})
            known = self._schemas[name] = (number, schema_record(number, name, text))
            self._pending.append(known[1])
        return known[0]

    def add(self, channel: int, stamp: int, text: str) -> None:
        """Add one message. stamp: ns of the world's clock. text: JSON in ASCII."""
        data = text.encode("ascii")
        self._sequence += 1
        length = _MESSAGE_HEAD + len(data)
        head = _MESSAGE(_MESSAGE_CODE, length, channel, self._sequence, stamp, stamp)
        self._pending += (head, data)
        self._counts[channel] += 1
        self._last = max(self._last, stamp)

    def flush(self) -> None:
        """Hand everything to the operating system."""
        data = memoryview(b"".join(self._pending))
        self._pending.clear()
        while data:
            data = data[self._raw.write(data) :]
        self._whole = self._raw.tell()

    def finish(self) -> None:
        """Write the summary and close."""
        self._pending.append(data_end_record())
        self.flush()
        start = at = self._whole
        statistics = statistics_record(self._counts, len(self._schemas), self._last)
        offsets = []
        for code, records in (
            (SCHEMA, [record for _, record in self._schemas.values()]),
            (CHANNEL, [record for _, record in self._channels.values()]),
            (STATISTICS, [statistics]),
        ):
            group = b"".join(records)
            self._pending.append(group)
            offsets.append(offset_record(code, at, len(group)))
            at += len(group)
        self._pending += (*offsets, footer_record(start, at), MAGIC)
        self.close()

    def close(self) -> None:
        """Write what is left and close; without `finish` the file counts as cut off."""
        if not self._raw.closed:
            self.flush()
            self._raw.close()

    def abandon(self) -> None:
        """Give up after an error; whole messages stay readable."""
        with suppress(OSError):
            self.flush()
        with suppress(OSError):
            os.ftruncate(self._raw.fileno(), self._whole)
        with suppress(OSError):
            self._raw.close()

    @property
    def removed(self) -> bool:
        """Whether somebody has deleted the file."""
        return not self.path.exists()
