"""One line per step of the set-up, while everything that its commands say goes into a log file.

Only the standard library is used here: nothing is installed yet.
"""

from __future__ import annotations

import os
import queue
import re
import shutil
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TextIO

LAST_LINES = 12
"""How much of the log an error repeats."""
REFRESH_SECONDS = 0.5
REMINDER_SECONDS = 20.0
"""How often a step tells how far it is where lines cannot be rewritten, such as in a CI log."""


class StepFailed(Exception):
    """A command of a step failed; the message has its last lines and names the log."""


class Steps:
    """Numbers the steps, shows how far each is, and logs their commands."""

    def __init__(self, titles: list[str], log: Path, stream: TextIO) -> None:
        self._titles, self._stream = titles, stream
        self._log = Log(log)
        self._rewrites = stream.isatty() and os.environ.get("TERM") != "dumb"
        self._done = 0

    def run(self, *commands: list[str], progress: Progress | None = None) -> None:
        """Run the commands of the next step one after the other.

        Raises:
            StepFailed: a command ended with an error.
        """
        number, title = self._done + 1, self._titles[self._done]
        self._done = number
        head = f"  {number}/{len(self._titles)} {title}"
        start = reminded = time.monotonic()
        for command in commands:
            for code in self._log.call(command, progress.read if progress else None):
                now = time.monotonic()
                if code is None and (self._rewrites or now - reminded > REMINDER_SECONDS):
                    reminded = now
                    told = progress.text() if progress else ""
                    self._show(f"{head}{told and f': {told}'} ({now - start:.0f} s)", last=False)
                elif code:
                    self._show(f"{head}: failed", last=True)
                    raise StepFailed(self._log.end())
        done = progress.result() if progress else ""
        self._show(f"{head}{done and f': {done}'} ({time.monotonic() - start:.0f} s)", last=True)

    def _show(self, text: str, last: bool) -> None:
        if self._rewrites:
            width = shutil.get_terminal_size().columns - 1
            self._stream.write(f"\r{text[:width]}\x1b[K" + ("\n" if last else ""))
        else:
            self._stream.write(f"{text}\n")
        self._stream.flush()


class Log:
    """A file with every command and everything that it said."""

    def __init__(self, path: Path) -> None:
        self._path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("", encoding="utf-8")

    def call(self, command: list[str], read: Callable[[str], None] | None) -> Iterator[int | None]:
        """Yield None while the command runs, about twice a second, then its exit code."""
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        with self._path.open("a", encoding="utf-8") as log:
            log.write(f"$ {' '.join(command)}\n")
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                env=environment,
                text=True,
                errors="replace",
            )
            try:
                for line in _lines(process):
                    if line is None:
                        yield None
                        continue
                    log.write(line)
                    log.flush()
                    if read is not None:
                        read(line)
            except BaseException:
                process.kill()
                raise
            yield process.wait()

    def end(self) -> str:
        """The last lines, and where the rest is."""
        lines = self._path.read_text(encoding="utf-8").splitlines()
        told = [line for line in lines if line.strip() and not line.startswith("WARNING:")]
        return "\n".join([*(f"  | {line}" for line in told[-LAST_LINES:]), f"  log: {self._path}"])


def _lines(process: subprocess.Popen[str]) -> Iterator[str | None]:
    """The lines of a process, and None whenever it says nothing for a moment."""
    said: queue.Queue[str | None] = queue.Queue()

    def listen() -> None:
        assert process.stdout is not None
        for line in process.stdout:
            said.put(line)
        said.put(None)

    threading.Thread(target=listen, daemon=True).start()
    while True:
        try:
            line = said.get(timeout=REFRESH_SECONDS)
        except queue.Empty:
            yield None
            continue
        if line is None:
            return
        yield line
        yield None


class Progress:
    """What pip has done so far, read from its lines and from the folder that it fills."""

    def __init__(self, packages: Path, expected: int) -> None:
        """`packages`: where they are installed; `expected`: about how many there will be."""
        self._packages, self._expected = packages, expected
        self._found: set[str] = set()
        self._megabytes = 0.0
        self._installing = self._before = 0

    def read(self, line: str) -> None:
        """Take in one line of `pip install`."""
        line = line.strip()
        if match := re.match(r"(?:Collecting|Requirement already satisfied:) ([\w.-]+)", line):
            self._found.add(match[1].lower().replace("_", "-"))
        elif match := re.match(
            r"Downloading \S+\.(?:whl|tar\.gz|zip) \(([\d.]+) (k|M|G)?B\)", line
        ):
            self._megabytes += float(match[1]) * {"k": 0.001, "M": 1.0, "G": 1000.0}.get(
                match[2], 0
            )
        elif line.startswith("Installing collected packages:"):
            self._installing = line.count(",") + 1
            self._before = self._installed()

    def text(self) -> str:
        """How far it is, such as "37 of about 150 found, 120 MB" or "60 of 141 installed"."""
        if self._installing:
            here = min(self._installed() - self._before, self._installing)
            return f"{here} of {self._installing} installed"
        return f"{len(self._found)} of about {self._expected} found{self._fetched()}"

    def result(self) -> str:
        """What it came to."""
        return f"{self._installing} installed{self._fetched()}"

    def _fetched(self) -> str:
        return f", {self._megabytes:.0f} MB downloaded" if self._megabytes >= 1 else ""

    def _installed(self) -> int:
        return sum(1 for _ in self._packages.glob("*.dist-info"))
