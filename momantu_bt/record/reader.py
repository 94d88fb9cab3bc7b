"""Reading a record back, whole or cut off."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from mcap.exceptions import McapError
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader

from momantu_bt.engine.role import Role
from momantu_bt.errors import MomantuError
from momantu_bt.record.about import FORMAT
from momantu_bt.record.codec import CodecError, from_json
from momantu_bt.record.folder import LOG
from momantu_bt.record.recording import (
    ChangeRecord,
    NodeInfo,
    Recording,
    StepRecord,
    TickRecord,
)
from momantu_bt.record.soundness import check_sound

__all__ = [
    "ChangeRecord",
    "NodeInfo",
    "RecordError",
    "Recording",
    "StepRecord",
    "TickRecord",
    "read_record",
]

_AGAIN = "$again"


class RecordError(MomantuError):
    """A folder holds no record that can be read; the message says why and what to do."""


def read_record(folder: Path) -> Recording:
    """Read the record in a folder (or the `run.mcap` in it), a cut-off one as far as it goes.

    Raises:
        RecordError: there is no record, it has no beginning, or another version wrote it.
    """
    path = folder / LOG if folder.is_dir() else folder
    raw, complete = _messages(path)
    try:
        about = _first(raw, "/run")
        if about is None:
            raise RecordError(f"{path} ends before it says which run it is; record the run again")
        if about["format"] != FORMAT:
            raise RecordError(
                f"{path} has format {about['format']}, this version reads {FORMAT}; it was written "
                f"by momantu-bt {about.get('versions', {}).get('momantu-bt', 'unknown')}"
            )
        files = [json.loads(text) for _, text in raw.get("/files", ())]
        nodes = _first(raw, "/nodes") or {"nodes": []}
        recording = Recording(
            folder=path.parent,
            about=about,
            files={file["name"]: file["text"] for file in files},
            nodes=tuple(map(_node, nodes["nodes"])),
            ticks=_Ticks().all(raw.get("/tick", ())),
            report=_first(raw, "/end"),
            complete=complete and "/end" in raw,
            kinds={file["name"]: file["kind"] for file in files},
            raw={topic: tuple(found) for topic, found in raw.items()},
        )
        check_sound(recording)
    except (CodecError, KeyError, TypeError, ValueError, RecursionError) as error:
        raise RecordError(f"{path} is damaged: {error!r}") from None
    return recording


def _messages(path: Path) -> tuple[dict[str, list[tuple[float, bytes]]], bool]:
    """All messages by topic with their time in s, and whether the file has its end."""
    try:
        file = path.open("rb")
    except OSError as error:
        raise RecordError(
            f"{path} cannot be read ({error.strerror}); expected a folder that "
            "`momantu-bt run --record FOLDER` has made"
        ) from None
    raw: dict[str, list[tuple[float, bytes]]] = {}
    with file:
        try:
            for topic, time, text in _records(file):
                raw.setdefault(topic, []).append((time, text))
        except (McapError, struct.error, ValueError, KeyError):
            if not raw:
                raise RecordError(
                    f"{path} is not a record, or was cut off at its beginning"
                ) from None
            return raw, False
    return raw, True


def _records(file: BinaryIO) -> Iterator[tuple[str, float, bytes]]:
    """Topic, seconds and text of each whole message.

    A message that was cut short only has the rest of the file, so the end is checked.
    """
    size = file.seek(0, 2)
    file.seek(0)
    topics: dict[int, str] = {}
    for record in StreamReader(file, record_size_limit=size).records:
        if isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Message):
            if file.tell() == size and not record.data.endswith(b"}"):
                raise struct.error("the last message is cut off")
            yield topics[record.channel_id], record.log_time * 1e-9, record.data


def _first(raw: Mapping[str, list[tuple[float, bytes]]], topic: str) -> Any:
    found = raw.get(topic)
    return json.loads(found[0][1]) if found else None


def _node(data: Mapping[str, Any]) -> NodeInfo:
    plan = tuple((str(prefix), bool(is_node)) for prefix, is_node in data.get("plan", ()))
    return NodeInfo(**{**data, "role": Role(data["role"]), "plan": plan})


class _Ticks:
    """Messages of `/tick` as values; a name for an earlier value gives the same object again."""

    def __init__(self) -> None:
        self._reads: dict[str, Any] = {}
        self._goals: dict[str, Any] = {}
        self._failures: dict[int, Any] = {}

    def all(self, messages: Any) -> tuple[TickRecord, ...]:
        return tuple(self._tick(json.loads(text)) for _, text in messages)

    def _tick(self, data: Mapping[str, Any]) -> TickRecord:
        return TickRecord(
            number=data["number"],
            now=data["now"],
            changes=tuple(
                ChangeRecord(node, status, note, self._failure(node, failure))
                for node, status, note, failure in data.get("changes", ())
            ),
            writes=tuple((cell, from_json(value)) for cell, value in data.get("writes", ())),
            reads=tuple(_resolved(self._reads, read) for read in data.get("reads", ())),
            issued=tuple(_resolved(self._goals, goal) for goal in data.get("issued", ())),
            state=data.get("state", ""),
            steps=tuple(
                StepRecord(node, status, phase, from_json(failure), from_json(outputs))
                for node, status, phase, failure, outputs in data.get("steps", ())
            ),
            settling=data.get("settling", False),
            notes=tuple((node, note) for node, note in data.get("notes", ())),
            labels=tuple((node, label) for node, label in data.get("labels", ())),
            logs=tuple((node, text) for node, text in data.get("logs", ())),
        )

    def _failure(self, node: int, data: Any) -> Any:
        if data is None:
            return None
        if _AGAIN in data:
            return self._failures[data[_AGAIN]]
        self._failures[node] = from_json(data)
        return self._failures[node]


def _resolved(last: dict[str, Any], pair: Any) -> tuple[str, Any]:
    name, data = pair
    if not (isinstance(data, dict) and _AGAIN in data):
        last[name] = from_json(data)
    return name, last[name]
