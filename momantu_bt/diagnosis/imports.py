"""Checks imports, each in a process of its own: a library that crashes does not end `doctor`."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterable

IMPORT_SECONDS = 120.0
"""Time for all imports of one call together; from a cold disk they take many seconds."""

_PROGRAM = """
import importlib, sys
for name in sys.argv[1:]:
    print("TRY", name, flush=True)
    try:
        importlib.import_module(name)
    except Exception as error:
        print("BAD", name, f"{type(error).__name__}: {error}".replace("\\n", " "), flush=True)
    else:
        print("GOOD", name, flush=True)
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
    waiting = [name for name in names if importlib.util.find_spec(name) is not None]
    errors: dict[str, str] = {}
    while waiting:
        done, reason = _attempt(waiting)
        for name, error in done.items():
            if error:
                errors[name] = error
        waiting = [name for name in waiting if name not in done]
        if waiting:
            # The process ended during this import; go on with the next one.
            errors[waiting.pop(0)] = reason
    return errors


def _attempt(names: list[str]) -> tuple[dict[str, str], str]:
    """The result of each import (the reason, or "" if it worked), and why the process ended."""
    try:
        result = subprocess.run(
            [sys.executable, "-c", _PROGRAM, *names],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=IMPORT_SECONDS,
            check=False,
        )
        output, reason = result.stdout, f"importing it ended Python with {result.returncode}"
    except subprocess.TimeoutExpired as expired:
        said = expired.stdout or b""
        output = said.decode(errors="replace") if isinstance(said, bytes) else said
        reason = f"importing it took more than {IMPORT_SECONDS:.0f} s"
    done: dict[str, str] = {}
    for line in output.splitlines():
        sign, _, rest = line.partition(" ")
        name, _, error = rest.partition(" ")
        if sign in ("GOOD", "BAD"):
            done[name] = error
    return done, reason
