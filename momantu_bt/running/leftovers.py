"""What skills, services and worlds leave behind in the process: threads, children, changed state.

A run puts the state back and names the rest. Nothing of it may keep the process from ending.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

GRACE = 0.2
"""Seconds of wall time that a thread has to end by itself after the run."""
LAST = 3.0
"""Seconds after which a process whose threads do not end is ended."""


class Leftovers:
    """The process as it is before the first tick; `told` compares it with what it is later.

    streams: standard output and error as they should be later, if a display replaces them now.
    """

    def __init__(self, streams: tuple[TextIO, TextIO] | None = None) -> None:
        self._threads = set(threading.enumerate())
        self._children = _children()
        self._folder = _folder()
        self._out, self._err = streams or (sys.stdout, sys.stderr)

    def expect_threads(self) -> None:
        """The threads that there are now may last: they are those of observers."""
        self._threads |= set(threading.enumerate())

    def told(self) -> list[str]:
        """Put back the working directory and the standard streams; say what else is left."""
        found = [*self._put_back()]
        for thread in _lasting(self._threads):
            found.append(f"the thread {thread.name!r}, which the run began, has not ended")
        for pid in sorted(_children() - self._children):
            name = _name(pid)
            if name:
                found.append(f"the process {pid} ({name}), which the run began, has not ended")
        return found

    def _put_back(self) -> Iterator[str]:
        folder = _folder()
        if self._folder is not None and folder != self._folder:
            try:
                os.chdir(self._folder)
            except OSError:
                yield f"the run changed the working directory, and {self._folder} is gone"
            else:
                yield f"the run changed the working directory to {folder}; it is as before again"
        if sys.stdout is not self._out or sys.stderr is not self._err:
            sys.stdout, sys.stderr = self._out, self._err
            yield "the run left Python's standard output redirected; it is as before again"


@contextmanager
def no_sudden_exit() -> Iterator[None]:
    """While it is entered, `os._exit` raises SystemExit in this process, so the robot is stopped.

    In children, for which it is meant, it works as usual. An exit from native code is not caught.
    """
    leave, process = os._exit, os.getpid()

    def refuse(status: int) -> None:
        if os.getpid() != process:
            leave(status)
        raise SystemExit(f"os._exit({status}) in the middle of a run")

    setattr(os, "_exit", refuse)  # noqa: B010 - typed as never returning
    try:
        yield
    finally:
        setattr(os, "_exit", leave)  # noqa: B010


def end_with(code: int) -> None:
    """Make sure that the process ends with this exit code, whatever threads and children it has.

    Call it last: Python waits for threads before it ends, and after LAST seconds this ends it.
    """
    if not _lasting(set()) and not _children():
        return
    timer = threading.Timer(LAST, _leave, (code, os._exit))
    timer.daemon = True
    timer.start()


def _leave(code: int, leave: Callable[[int], None]) -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError, AttributeError):
            continue
    leave(code)


def _lasting(before: set[threading.Thread]) -> list[threading.Thread]:
    """Threads beyond `before` that Python would wait for, after GRACE."""
    here = threading.current_thread()
    main = threading.main_thread()
    fresh = [t for t in threading.enumerate() if t not in before and not t.daemon]
    fresh = [t for t in fresh if t is not here and t is not main]
    for thread in fresh:
        thread.join(GRACE)
    return [thread for thread in fresh if thread.is_alive()]


def _children() -> set[int]:
    """Process ids of the children of all threads; empty where the system does not tell."""
    found: set[int] = set()
    for file in Path("/proc/self/task").glob("*/children"):
        try:
            found.update(map(int, file.read_text(encoding="ascii").split()))
        except OSError:
            continue
    return found


def _name(pid: int) -> str:
    """The program's name; empty if the process has ended."""
    try:
        line = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
    name, _, rest = line.partition("(")[2].rpartition(")")
    return "" if rest.split()[0] == "Z" else name


def _folder() -> str | None:
    try:
        return str(Path.cwd())
    except OSError:  # it has been deleted
        return None
