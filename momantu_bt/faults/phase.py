"""When a fault begins, as it is written.

A phase is one of these: `start`; a time, `12 s`; names such as `Serve/dock`, for the first tick at
which a node called dock is RUNNING inside one called Serve; `after-dock`, for the tick after a node
called dock ended in SUCCESS. Behind names, `#2` means the second such time and `+3 s` means 3 s
later.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from momantu_bt.formats.units import UnitError, in_unit

START = "start"
FORMS = "start, 12 s, NAME, OUTER/INNER, after-NAME, NAME#2 or NAME+3 s"
_AFTER = "after-"
_TAIL = re.compile(r"(?P<names>.*?)(?:#(?P<count>[^#+]*))?(?:\+(?P<delay>[^#+]*))?", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Phase:
    """When something begins.

    names: of nodes, the outermost first; empty: the clock alone decides. after: begins with the end
    in SUCCESS rather than with RUNNING. count: which such time, from 1. delay: s after that time;
    without names, s of the clock.
    """

    names: tuple[str, ...] = ()
    after: bool = False
    count: int = 1
    delay: float = 0.0


def parse_phase(text: str) -> Phase:
    """Parse a phase.

    Raises:
        ValueError: the text is no phase; the message says what is valid.
    """
    match = _TAIL.fullmatch(text.strip())
    assert match is not None
    names, count, delay = match["names"].strip(), match["count"], match["delay"]
    later = 0.0 if delay is None else _seconds(delay)
    if later is None:
        raise ValueError(f"+{delay}: expected a time, such as +3 s")
    clock = _seconds(names)
    if names == START or clock is not None:
        if count is not None:
            raise ValueError(f"{names} comes once; #{count} belongs behind a node's name")
        return Phase(delay=(clock or 0.0) + later)
    after = names.startswith(_AFTER)
    parts = tuple(part.strip() for part in names.removeprefix(_AFTER).split("/"))
    if not all(parts):
        raise ValueError(f"{text!r} is not a phase; expected {FORMS}")
    return Phase(parts, after, _counted(count), later)


def _counted(text: str | None) -> int:
    if text is None:
        return 1
    if not text.strip().isdecimal() or int(text) < 1:
        raise ValueError(f"#{text}: expected a whole number from 1, such as #2")
    return int(text)


def _seconds(text: str) -> float | None:
    """A time of 0 s or more; None if the text is not a time."""
    try:
        found = in_unit(text, "s")
    except UnitError as error:
        raise ValueError(str(error)) from None
    return found if found is None or found >= 0.0 else None
