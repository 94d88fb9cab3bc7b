"""Checks imports, each in a process of its own: a library that crashes does not end `doctor`."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator

IMPORT_SECONDS = 120.0
"""Time for all imports of one call together; from a cold disk they take many seconds."""

_PROGRAM = """
import importlib, os, sys
told = os.fdopen(os.dup(1), "w")  # what a library prints must not get between the lines
os.dup2(2, 1)
for name in sys.argv[1:]:
    print("TRY", name, file=told, flush=True)
    try:
        importlib.import_module(name)
    except BaseException as error:
        try:
            said = f"{type(error).__name__}: {error}".replace("\\n", " ")
        except Exception:
            said = type(error).__name__
        print("BAD", name, said, file=told, flush=True)
    else:
        print("GOOD", name, file=told, flush=True)
told.close()
os._exit(0)  # threads that an import began are not waited for
"""


_NO_LIBRARY = re.compile(r"(?P<file>\S+\.so[.\d]*): cannot open shared object file")


def import_cure(name: str, reason: str) -> str:
    """The cure for an import error: a system package, or reinstalling the module."""
    library = _NO_LIBRARY.search(reason)
    if library is not None:
        return f"install the system's package that holds {library['file']}"
    return f"`pip install --force-reinstall` the package of {name}"


def import_errors(names: Iterable[str]) -> dict[str, str]:
    """Import modules one by one; returns why, for each that exists but cannot be imported."""
    there = [name for name in names if importlib.util.find_spec(name) is not None]
    return {name: reason for name, reason, _ in _trials(there, IMPORT_SECONDS) if reason}


def fatal_imports(names: Iterable[str], seconds: float) -> dict[str, str]:
    """Import modules one by one; returns why, for each that hangs or ends the process.

    seconds: limit of wall time for those that are left after each of these.
    """
    return {name: reason for name, reason, fatal in _trials([*names], seconds) if fatal}


def _trials(waiting: list[str], seconds: float) -> Iterator[tuple[str, str, bool]]:
    """The result of each import: the reason, or "" if it worked; and whether it was fatal."""
    while waiting:
        done, reason = _attempt(waiting, seconds)
        for name, error in done.items():
            yield name, error, False
        waiting = [name for name in waiting if name not in done]
        if waiting:
            # The process ended during this import; go on with the next one.
            yield waiting.pop(0), reason, True


def _attempt(names: list[str], seconds: float) -> tuple[dict[str, str], str]:
    """The result of each import (the reason, or "" if it worked), and why the process ended."""
    try:
        result = subprocess.run(
            [sys.executable, "-c", _PROGRAM, *names],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
        output, reason = result.stdout, f"importing it ended Python with {result.returncode}"
    except subprocess.TimeoutExpired as expired:
        said = expired.stdout or b""
        output = said.decode(errors="replace") if isinstance(said, bytes) else said
        reason = f"importing it took more than {seconds:.0f} s"
    done: dict[str, str] = {}
    for line in output.splitlines():
        sign, _, rest = line.partition(" ")
        name, _, error = rest.partition(" ")
        if sign in ("GOOD", "BAD"):
            done[name] = error
    return done, reason
