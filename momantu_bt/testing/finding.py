"""What `check_skill` finds."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that is wrong with a skill.

    rule: its short name, such as "wall-clock". place: `file:line`, empty where no line is to
    blame. note: not wrong in itself, but something was left untried because of it.
    """

    rule: str
    message: str
    place: str = ""
    note: bool = False

    def __str__(self) -> str:
        where = f" ({self.place})" if self.place else ""
        return f"{'note' if self.note else self.rule}: {self.message}{where}"
