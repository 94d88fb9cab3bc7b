"""What Ctrl-C means before a run has begun."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from momantu_bt.errors import ExitCode, MomantuError


class NotStarted(MomantuError):
    """Ctrl-C came before the first tick."""

    exit_code = ExitCode.INTERRUPTED


@contextmanager
def before_the_first_tick() -> Iterator[None]:
    """Say of a Ctrl-C in the block that nothing has begun: a run that has begun takes its own.

    Raises:
        NotStarted: there was one.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise NotStarted("interrupted before the first tick; nothing was started") from None
