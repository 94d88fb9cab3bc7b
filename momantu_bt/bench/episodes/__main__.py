"""Start the process of an episode: `python -m momantu_bt.bench.episodes SPEC ROW PARENT`.

PARENT is the number of the process that waits for this one. The kernel ends this process when that
one is gone, from before the slow imports on.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys

from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt.bench.episodes import episode
    from momantu_bt.running import leftovers

_PR_SET_PDEATHSIG = 1
"""`prctl(2)`: the signal that a process gets when its parent dies."""


def main() -> None:
    """End with the exit code of the episode."""
    told, row, parent = sys.argv[1:]
    _end_with_parent(int(parent))
    code = episode.main(told, row)
    leftovers.end_with(code)
    raise SystemExit(code)


def _end_with_parent(parent: int) -> None:
    """Let the kernel end this process when its parent is gone, however that ended."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # gone before the line above; nothing has begun, so nothing is lost
        os._exit(os.EX_TEMPFAIL)


if __name__ == "__main__":
    main()
