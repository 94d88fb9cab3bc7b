"""The rows of a bench on disk: a folder with an append-only `results.jsonl`.

Each row is one write and is on the disk before the next episode counts as done. If a crash cuts a
line, the next opening of the folder drops that line and keeps all others.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

from momantu_bt.bench.rows.spec import Row
from momantu_bt.errors import MomantuError
from momantu_bt.formats.files import OutputError

RESULTS, LOCK = "results.jsonl", ".lock"


class StoreError(MomantuError):
    """A folder of results cannot be used; the message says why and what to do."""


class Store:
    """A folder of results that this process alone adds to; use it as a context.

    Raises:
        OutputError: the folder cannot be made or written.
        StoreError: another process has it open, or a line in it is not a row.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._lock = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise OutputError(f"{folder} cannot be written: {error.strerror or error}") from None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._lock)
            raise StoreError(
                f"another bench is writing to {folder}; wait for it, or choose another --out"
            ) from None
        try:
            self._rows = {row["key"]: row for row in read_rows(folder)}
            self._file = self._open(folder / RESULTS)
        except BaseException:
            os.close(self._lock)
            raise

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.close(self._file)
        os.close(self._lock)

    @property
    def rows(self) -> Mapping[str, Row]:
        """All rows by their keys, in the order in which they were added."""
        return self._rows

    def add(self, row: Row) -> None:
        """Add a row; once this returns, the row survives a crash.

        Raises:
            OutputError: the disk is full; nothing of the row stays.
        """
        line = json.dumps(row, default=str, separators=(",", ":")).encode() + b"\n"
        before = os.fstat(self._file).st_size
        try:
            written = os.write(self._file, line)
            if written < len(line):
                raise OSError(f"only {written} of {len(line)} bytes were written")
            os.fsync(self._file)
        except OSError as error:
            os.ftruncate(self._file, before)
            path = self.folder / RESULTS
            raise OutputError(f"{path} cannot be written: {error.strerror or error}") from None
        self._rows[row["key"]] = row

    @staticmethod
    def _open(path: Path) -> int:
        """Open for adding, without a last line that was cut."""
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
            text = path.read_bytes()
            os.ftruncate(file, text.rfind(b"\n") + 1)
        except OSError as error:
            raise OutputError(f"{path} cannot be written: {error.strerror or error}") from None
        return file


def read_rows(folder: Path) -> list[Row]:
    """All whole rows of a folder of results, oldest first; empty if there is no file yet.

    Raises:
        StoreError: the file cannot be read, or a whole line in it is not a row.
    """
    path = folder / RESULTS
    try:
        *lines, _cut = path.read_bytes().split(b"\n")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise StoreError(f"{path} cannot be read: {error.strerror or error}") from None
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            row = json.loads(line)
            _ = row["key"], row["seed"]
        except (ValueError, KeyError, TypeError):
            raise StoreError(
                f"{path}:{number} is not a row of a bench; remove that line to go on"
            ) from None
        rows.append(row)
    return rows
