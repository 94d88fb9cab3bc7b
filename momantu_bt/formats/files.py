"""Writing files whole or not at all."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from momantu_bt.errors import MomantuError


class OutputError(MomantuError, OSError):
    """A file cannot be written where the user wants it; the message says why."""


def write_whole(path: Path, content: str | bytes, *, folders: bool = False) -> None:
    """Write a file under a temporary name, then rename it.

    folders: also make missing folders above it.

    Raises:
        OutputError: the folder is missing or read-only, or the disk is full.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        if folders:
            path.parent.mkdir(parents=True, exist_ok=True)
        draft.write_bytes(content.encode() if isinstance(content, str) else content)
        draft.replace(path)
    except OSError as error:
        with suppress(OSError):
            draft.unlink()
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from None


def check_writable(path: Path) -> None:
    """Check that a file can be written at a path, before the work for it starts.

    Raises:
        OutputError: its folder does not exist or cannot be written, or it is a folder itself.
    """
    folder = path.parent
    probe = folder / f".{path.name}.{os.getpid()}.probe"
    try:
        if path.is_dir():
            raise OutputError(f"{path} is a folder, expected the name of a file to write")
        if not folder.is_dir():
            raise OutputError(f"{path} cannot be written: there is no folder {folder}")
        probe.touch()
        probe.unlink()
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(
            f"{path} cannot be written: {error.strerror or error}; choose a folder that is yours"
        ) from None
