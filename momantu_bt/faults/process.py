"""Killing the process."""

from __future__ import annotations

import os
import signal


class Killed:
    """`process.killed`. Implements `Effect`."""

    def begin(self) -> None:
        """End the process at once; nobody is told."""
        os.kill(os.getpid(), signal.SIGKILL)

    def end(self) -> None:
        """Nothing is left to mend."""
