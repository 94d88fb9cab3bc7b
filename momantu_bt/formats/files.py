"""Writing files whole or not at all.

A link stays a link: the file it names is replaced. What is no regular file, such as a device, a
FIFO or the process's own standard output, is written to.
"""

from __future__ import annotations

import errno
import os
import re
import select
import stat
import sys
import time
from contextlib import suppress
from pathlib import Path

from momantu_bt.errors import MomantuError

READER_SECONDS = 5.0
"""Wall time in which the reader of a FIFO must open it, and must take each next piece."""
_OWN = re.compile(r"/(?:dev/fd|proc/(?:self|\d+)/fd)/(\d+)")
"""A file that the process has open, by the number of its descriptor."""
_STANDARD = {"/dev/stdin": 0, "/dev/stdout": 1, "/dev/stderr": 2}
_PAUSE = 0.05


class OutputError(MomantuError, OSError):
    """A file cannot be written where the user wants it; the message says why."""


def write_whole(path: Path, content: str | bytes, *, folders: bool = False) -> None:
    """Write a file under a temporary name, then rename it; write into what is no regular file.

    folders: also make missing folders above it.

    Raises:
        OutputError: the folder is missing or read-only, the disk is full, or nobody reads a FIFO.
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        if folders:
            path.parent.mkdir(parents=True, exist_ok=True)
        if is_special(path):
            _write_into(path, data)
        else:
            _replace(Path(os.path.realpath(path)), data)
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from None


def check_writable(path: Path, *, regular: bool = False) -> None:
    """Check that a file can be written at a path, before the work for it starts.

    regular: only a regular file will do, as its writer goes back and forth in it.

    Raises:
        OutputError: its folder does not exist or cannot be written, or it is a folder itself.
    """
    try:
        if path.is_dir():
            raise OutputError(f"{path} is a folder, expected the name of a file to write")
        if is_special(path):
            _check_special(path, regular=regular)
        else:
            _probe(path)
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(
            f"{path} cannot be written: {error.strerror or error}; choose a folder that is yours"
        ) from None


def is_special(path: Path) -> bool:
    """Whether a path names a device, a FIFO, a socket or an open file of this process."""
    if _descriptor(path) is not None:
        return True
    try:
        return not stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return False


def _descriptor(path: Path) -> int | None:
    """The number of an open file of this process that a path names, as /dev/stdout does."""
    text = os.path.normpath(path.absolute())
    if text in _STANDARD:
        return _STANDARD[text]
    own = _OWN.fullmatch(text)
    return None if own is None else int(own[1])


def _check_special(path: Path, *, regular: bool) -> None:
    if regular:
        raise OutputError(f"{path} is no regular file; expected the name of a file to write")
    number = _descriptor(path)
    if number is not None:
        os.fstat(number)
    elif not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def _probe(path: Path) -> None:
    folder = Path(os.path.realpath(path)).parent
    if not folder.is_dir():
        raise OutputError(f"{path} cannot be written: there is no folder {_shown(folder, path)}")
    with suppress(FileNotFoundError):
        path.lstat()  # a name that is too long raises
    probe = folder / f".{os.getpid()}.probe"
    probe.touch()
    probe.unlink()


def _replace(target: Path, data: bytes) -> None:
    """Write beside the file, then rename; the permissions of a file that was there stay."""
    draft = target.with_name(f".{target.name[:50]}.{os.getpid()}.part")
    try:
        draft.write_bytes(data)
        with suppress(FileNotFoundError):
            draft.chmod(stat.S_IMODE(target.stat().st_mode))
        draft.replace(target)
    except BaseException:
        with suppress(OSError):
            draft.unlink()
        raise


def _write_into(path: Path, data: bytes) -> None:
    number = _descriptor(path)
    if number is not None:
        for stream in (sys.stdout, sys.stderr):  # what was printed before comes first
            if stream is not None:
                stream.flush()
    file = _opened(path) if number is None else os.dup(number)
    try:
        while data:
            if not select.select([], [file], [], READER_SECONDS)[1]:
                raise OutputError(f"{path} cannot be written: its reader takes nothing any more")
            data = data[os.write(file, data[: select.PIPE_BUF]) :]
    finally:
        os.close(file)


def _opened(path: Path) -> int:
    """A device or FIFO opened for writing; a FIFO waits for its reader, but not for ever."""
    until = time.monotonic() + READER_SECONDS
    while True:
        try:
            return os.open(path, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY)
        except OSError as error:
            if not path.is_fifo() or time.monotonic() > until:
                why = "nobody reads it" if path.is_fifo() else error.strerror
                raise OutputError(f"{path} cannot be written: {why}") from None
        time.sleep(_PAUSE)


def _shown(folder: Path, path: Path) -> Path:
    """The folder as the user wrote it, unless a link leads elsewhere."""
    return path.parent if folder == Path(os.path.realpath(path.parent)) else folder
