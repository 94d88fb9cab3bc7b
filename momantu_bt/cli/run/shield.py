"""Displays that break without breaking the run: what cannot be shown never stops a robot."""

from __future__ import annotations

from collections.abc import Callable

from momantu_bt.engine.executor import Executor, Observer
from momantu_bt.errors import words_of


class Shielded:
    """An observer whose first error ends it, with one remark; the run goes on.

    what: what breaks, for the remark. on_break: called after it.
    """

    def __init__(
        self,
        observer: Observer,
        what: str,
        remark: Callable[[str], None],
        on_break: Callable[[], object],
    ) -> None:
        self._observer: Observer | None = observer
        self._what, self._remark, self._on_break = what, remark, on_break

    def ticked(self, run: Executor) -> None:
        """Pass the tick on, unless the observer is broken."""
        if self._observer is None:
            return
        try:
            self._observer.ticked(run)
        except Exception as error:
            self._give_up(error)

    def close(self) -> None:
        """Close the observer, unless it is broken."""
        observer, self._observer = self._observer, None
        if observer is None:
            return
        try:
            observer.close()
        except Exception as error:
            self._tell(error)

    def _give_up(self, error: Exception) -> None:
        observer, self._observer = self._observer, None
        self._tell(error)
        try:
            if observer is not None:
                observer.close()
        except Exception:  # it is broken already, and that was said
            return

    def _tell(self, error: Exception) -> None:
        why = (isinstance(error, OSError) and error.strerror) or words_of(error)
        self._remark(f"{self._what} breaks off here: {why}; the run goes on")
        self._on_break()
