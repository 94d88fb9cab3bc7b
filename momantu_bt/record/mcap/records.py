"""Records of an MCAP file as bytes, after https://mcap.dev/spec; all but messages.

The `mcap` package reads the files but does not write them: to import its records and to pass each
message through them takes a quarter of the time that a whole record may take.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, STATISTICS, OFFSET, DATA_END = 1, 2, 3, 4, 0x0B, 0x0E, 0x0F
"""Opcodes."""
LIBRARY = "momantu-bt"


def header_record() -> bytes:
    """The first record: no profile, and the library that wrote it."""
    return _record(HEADER, _text("") + _text(LIBRARY))


def schema_record(number: int, name: str, schema: str) -> bytes:
    """A JSON Schema under a name."""
    return _record(
        SCHEMA, struct.pack("<H", number) + _text(name) + _text("jsonschema") + _text(schema)
    )


def channel_record(number: int, schema: int, topic: str) -> bytes:
    """A channel of JSON messages, without metadata."""
    head = struct.pack("<HH", number, schema)
    return _record(CHANNEL, head + _text(topic) + _text("json") + struct.pack("<I", 0))


def statistics_record(counts: Mapping[int, int], schemas: int, last: int) -> bytes:
    """counts: messages by channel; last: the latest log time, ns. The first time is 0."""
    numbers = (sum(counts.values()), schemas, len(counts), 0, 0, 0, 0, last)
    pairs = b"".join(struct.pack("<HQ", *pair) for pair in counts.items())
    body = struct.pack("<QHIIIIQQ", *numbers) + struct.pack("<I", len(pairs)) + pairs
    return _record(STATISTICS, body)


def offset_record(code: int, start: int, length: int) -> bytes:
    """Where the summary holds the records of an opcode."""
    return _record(OFFSET, struct.pack("<BQQ", code, start, length))


def data_end_record() -> bytes:
    """The end of the messages; a checksum of 0 means none."""
    return _record(DATA_END, struct.pack("<I", 0))


def footer_record(summary: int, offsets: int) -> bytes:
    """Where the summary and its offsets begin; a checksum of 0 means none."""
    return _record(FOOTER, struct.pack("<QQI", summary, offsets, 0))


def _record(code: int, body: bytes) -> bytes:
    return struct.pack("<BQ", code, len(body)) + body


def _text(text: str) -> bytes:
    data = text.encode("utf-8")
    return struct.pack("<I", len(data)) + data
