"""Asking SAPIEN in a process of its own whether it can render; a failed attempt is final there."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from enum import StrEnum

PROBE_SECONDS = 120.0
"""Time limit: a cold import of SAPIEN from a slow disk takes seconds, and a hang must end."""


class Way(StrEnum):
    """The source of a process's window libraries and driver."""

    SYSTEM = "system"
    """Both from the machine."""
    SYSTEM_DRIVER = "system_driver"
    """Window libraries of ours, the machine's driver: a GPU server without X libraries."""
    PRIVATE = "private"
    """Both of ours."""


@dataclass(frozen=True, slots=True)
class ProbeResult:
    """device: what renders (`llvmpipe …` is software), empty when nothing does; reason: why."""

    device: str
    reason: str

    @property
    def renders(self) -> bool:
        """Something renders."""
        return bool(self.device)


_PROGRAM = """
import sys
from momantu_worlds.vulkan.use import apply
from momantu_worlds.vulkan.probe import Way
apply(Way(sys.argv[1]))
import sapien
sapien.render.set_log_level("off")
summary = sapien.render.get_device_summary()
print("DEVICE", " ".join(summary.strip().splitlines()[0].split()) if summary.strip() else "?")
"""


def probe(way: Way) -> ProbeResult:
    """Start SAPIEN's renderer once in a new process, the given way (1-3 s)."""
    environment = dict(os.environ)
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROGRAM, way.value],
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=PROBE_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return ProbeResult("", f"the renderer did not answer within {PROBE_SECONDS:.0f} s")
    for line in done.stdout.splitlines():
        if line.startswith("DEVICE "):
            return ProbeResult(line.removeprefix("DEVICE ").strip(), "")
    words = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return ProbeResult("", words[-1] if words else f"the renderer ended with {done.returncode}")
