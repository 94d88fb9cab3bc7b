"""Checks the machine: Python, memory, and the folders that are written to."""

from __future__ import annotations

import platform
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from momantu_bt.diagnosis import Diagnosis
from momantu_bt.formats.cache import CACHE_VARIABLE, cache_folder

OLDEST, NEWEST = (3, 11), (3, 12)
"""Python versions that every dependency has wheels for."""
MEMORY_NEEDED = 1.5e9
"""The most memory that one run should take, bytes."""

_CGROUP_FILES = (
    ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
    (
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
        "/sys/fs/cgroup/memory/memory.usage_in_bytes",
    ),
)


def machine(output: Path) -> Iterator[Diagnosis]:
    """Diagnoses of the machine; `output` is the folder for reports and videos."""
    yield python_version(sys.version_info[:2])
    yield memory(available_memory())
    yield writable("output folder", output, "name another folder: `momantu-bt doctor --output DIR`")
    yield writable("cache folder", cache_folder(), f"name another one in {CACHE_VARIABLE}")


def python_version(version: tuple[int, ...]) -> Diagnosis:
    """Whether all dependencies support this Python."""
    ok = OLDEST <= version[:2] <= NEWEST
    cure = "" if ok else "make the virtual environment with Python 3.11 or 3.12"
    return Diagnosis("Python", ok, f"{platform.python_version()} at {sys.executable}", cure)


def memory(available: float | None) -> Diagnosis:
    """Whether there is enough memory for one run; `available` in bytes, None if unknown."""
    if available is None:
        return Diagnosis("memory", True, "this system does not say how much is free")
    ok = available >= MEMORY_NEEDED
    detail = f"{available / 1e9:.1f} GB free, a run takes up to {MEMORY_NEEDED / 1e9:.1f} GB"
    return Diagnosis("memory", ok, detail, "" if ok else "close other programs, or add memory")


def available_memory() -> float | None:
    """Bytes for a new process: free memory, or what remains below the container's limit."""
    amounts: list[float] = []
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        amounts += [float(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvail")]
    except (OSError, ValueError, IndexError):
        pass
    for limit, used in _CGROUP_FILES:
        try:
            amounts.append(float(Path(limit).read_text()) - float(Path(used).read_text()))
        except (OSError, ValueError):
            continue
    return min(amounts, default=None)


def writable(name: str, folder: Path, cure: str) -> Diagnosis:
    """Whether a file can be written in `folder`, or in the nearest existing folder above it."""
    folder = folder.absolute()
    nearest = next(path for path in (folder, *folder.parents) if path.exists())
    try:
        with tempfile.TemporaryFile(dir=nearest):
            return Diagnosis(name, True, f"{folder} can be written")
    except OSError as error:
        return Diagnosis(name, False, f"{nearest} cannot be written: {error.strerror}", cure)
