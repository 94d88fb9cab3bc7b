"""Errors that make an import impossible, each at its place."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from momantu_bt.errors import MomantuError
from momantu_bt.formats.places import Place, marked

MOST_SHOWN_OF = 32_000_000
"""Largest file of which messages show lines, bytes."""


class SdfError(MomantuError):
    """An SDF world cannot be imported; the message says where, why and what to do."""

    def __init__(self, place: Place, message: str) -> None:
        self.place = place
        line = _line_at(place)
        super().__init__(f"{place}: {message}" + (f"\n{marked(place, line)}" if line else ""))


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
