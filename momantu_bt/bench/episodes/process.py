"""Run one episode in a process of its own, with a watchdog outside it.

`python -m momantu_bt.bench.episodes SPEC ROW PARENT` runs in a session of its own, so that a
hang in native code and whatever it started are killed together.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from momantu_bt.bench.rows.spec import (
    CRASHED,
    HUNG,
    IMPOSSIBLE,
    KILLED,
    REFUSED,
    REPORT,
    EpisodeSpec,
    Row,
)

_WITHOUT_ROW = {os.EX_UNAVAILABLE: IMPOSSIBLE, os.EX_TEMPFAIL: REFUSED}
"""Exit code -> how a process without a row ended; its printed output says why."""
ONE_THREAD = {"OMP_NUM_THREADS": "1", "LP_NUM_THREADS": "1"}
"""Give numerical libraries and the software renderer one thread each: episodes share the cores."""
_TRACEBACKS = re.compile(r"^Timeout \(\d+:\d\d:\d\d", re.MULTILINE)
"""The start of faulthandler's output when the run's own watchdog makes it end the process."""
MOST_OUTPUT = 4000
"""Keep this many characters of a process's output when it left no row."""


class EpisodeProcess:
    """One running episode. Use it as a context: leaving it ends the process and its children."""

    def __init__(self, spec: EpisodeSpec) -> None:
        self.spec = spec
        self._folder = tempfile.TemporaryDirectory(prefix="momantu_bt_episode_")
        folder = Path(self._folder.name)
        self._row_file, self._output = folder / "row.json", folder / "output.txt"
        told = folder / "spec.json"
        told.write_text(json.dumps(spec.as_dict()), encoding="utf-8")
        words = [str(told), str(self._row_file), str(os.getpid())]
        with self._output.open("wb") as output:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "momantu_bt.bench.episodes", *words],
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, **ONE_THREAD, "PYTHONFAULTHANDLER": "1"},
                start_new_session=True,
            )
        self._started = time.monotonic()
        self._overdue = False

    def __enter__(self) -> EpisodeProcess:
        return self

    def __exit__(self, *exception: object) -> None:
        self.kill()

    def wait(self, pause: float = 0.05) -> Row:
        """Its row, when it has ended or the watchdog has ended it."""
        while (row := self.poll()) is None:
            time.sleep(pause)
        return row

    def poll(self) -> Row | None:
        """Its row once it has ended, else None; past its limit it is killed."""
        pid, status, usage = os.wait4(self._process.pid, os.WNOHANG)
        wall = time.monotonic() - self._started
        if pid == 0:
            if wall > self.spec.limit and not self._overdue:
                self._overdue = True
                self._signal()
            return None
        self._signal()  # ends the children that it left behind
        code = self._process.returncode = os.waitstatus_to_exitcode(status)
        row = self._row(code)
        row["memory_mb"] = round(usage.ru_maxrss / 1024.0, 1)
        row["process_time_s"] = round(wall, 3)
        row["unix_time"] = round(time.time(), 3)
        self._folder.cleanup()
        return row

    def kill(self) -> None:
        """End it and all it started; safe to call twice."""
        if self._process.returncode is None:
            self._signal()
            self._process.wait()
        self._folder.cleanup()

    def _signal(self) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def _row(self, code: int) -> Row:
        row = self.spec.row()
        told = self._told()
        if told is not None:
            return {**row, **told, "exit_code": code, "ended": REPORT}
        said = self._output.read_text(encoding="utf-8", errors="replace")
        if self._overdue or (code == 1 and _TRACEBACKS.search(said)):
            ended = HUNG
        elif code < 0:
            ended = KILLED
        else:
            ended = _WITHOUT_ROW.get(code, CRASHED)
        return {**row, "exit_code": code, "ended": ended, "output": said[-MOST_OUTPUT:].strip()}

    def _told(self) -> Row | None:
        """The row that the process wrote; it is whole or not there."""
        try:
            told: Row = json.loads(self._row_file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        return told
