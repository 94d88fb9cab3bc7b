"""Checks of `momantu-bt doctor` for skills: whether libraries load, and which cv2 is installed."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from momantu_bt.diagnosis import Diagnosis
from momantu_bt.diagnosis.imports import import_cure, import_errors

LIBRARIES = ("pinocchio", "coal", "ompl", "toppra", "numba", "scipy", "pyapriltags")
PREPARATION = "momantu_skills.manipulation"
"""Imported before the libraries, as in the skills: it finds the OpenMP runtime that some need."""
HEADLESS = "opencv-python-headless"


def diagnose() -> Iterator[Diagnosis]:
    """Diagnose the libraries that the skills need; return nothing if none of them is installed."""
    present = [name for name in LIBRARIES if importlib.util.find_spec(name) is not None]
    errors = import_errors([PREPARATION, *present] if present else [])
    for name, reason in errors.items():
        yield Diagnosis(name, False, f"cannot be imported: {reason}", import_cure(name, reason))
    if present and not errors:
        yield Diagnosis("libraries for skills", True, f"{', '.join(present)} can be imported")
    if importlib.util.find_spec("cv2") is not None:
        yield _opencv()


def _opencv() -> Diagnosis:
    """Diagnose cv2: two packages install it, and the one with a display often cannot be loaded."""
    error = import_errors(["cv2"]).get("cv2")
    headless = _is_headless()
    build = "the headless build" if headless else "the build for screens"
    if error is None:
        return Diagnosis("cv2", True, f"{build}, can be imported")
    pinned = _pinned()
    command = f"{sys.executable} -m pip install --no-deps --force-reinstall {pinned}"
    return Diagnosis("cv2", False, f"{build}, cannot be imported: {error}", command, _lay_headless)


def _is_headless() -> bool:
    """Return whether the headless build is installed; reads the folder, as the import may fail."""
    spec = importlib.util.find_spec("cv2")
    if spec is None or spec.origin is None:
        return False
    file = Path(spec.origin).with_name("version.py")
    return file.is_file() and "headless = True" in file.read_text(encoding="utf-8")


def _pinned() -> str:
    try:
        return f"{HEADLESS}=={version(HEADLESS)}"
    except PackageNotFoundError:
        return HEADLESS


def _lay_headless() -> None:
    """Install the headless build over the installed cv2.

    Raises:
        RuntimeError: pip failed; the message is the last line that pip wrote.
    """
    command = ["install", "--quiet", "--no-deps", "--force-reinstall", _pinned()]
    done = subprocess.run(
        [sys.executable, "-m", "pip", *command], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines()
        raise RuntimeError(lines[-1] if lines else "pip failed")
