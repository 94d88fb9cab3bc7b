"""Errors that make an import impossible, each at its place."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from momantu_bt.errors import MomantuError
from momantu_bt.formats.places import Place, marked

MOST_SHOWN_OF = 32_000_000
"""Largest file of which messages show lines, bytes."""


class SdfError(MomantuError):
    """An SDF world, or an element of it, cannot be imported; the message says where and why.

    reason: the message without the place.
    """

    def __init__(self, place: Place, message: str) -> None:
        self.place, self.reason = place, message
        line = _line_at(place)
        super().__init__(f"{place}: {message}" + (f"\n{marked(place, line)}" if line else ""))


class TooMuch(SdfError):
    """A limit of the whole import is exceeded: no part of it is left out to go on."""


def _line_at(place: Place) -> str:
    """The line of the file, for messages; empty if it cannot be shown."""
    file = Path(place.file)
    try:
        if file.stat().st_size > MOST_SHOWN_OF:
            return ""
        with file.open("rb") as lines:
            found = next(islice(lines, place.line - 1, place.line), b"")
    except OSError:
        return ""
    text = found.decode("utf-8", "replace").rstrip()
    return text if place.column <= len(text) else ""
