"""What happens in a run, told at the instant at which it happens to everybody who subscribes.

Kinds of events stand beside what tells them: `Ticked`, `Stepping` and `NodeStarting` in
`executor.py`, `SkillStepped`, `SkillEnded` and `Answered` in `outside.py`, `Remarked` in
`context.py`, `SensorRead` in `actuators.py`. A subscriber only looks: the run is the same without.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

E = TypeVar("E")


class Events:
    """The stream of one run. Events of one kind reach their subscribers in order of subscription.

    What a subscriber raises, ends the run: who must not disturb it catches its own errors.
    """

    def __init__(self) -> None:
        self._subscribers: dict[type, list[Callable[[Any], None]]] = {}

    def subscribe(self, kind: type[E], hear: Callable[[E], None]) -> None:
        """Call `hear` with each event of a kind from now on."""
        self._subscribers.setdefault(kind, []).append(hear)

    def heard(self, kind: type) -> bool:
        """Whether anybody hears events of a kind."""
        return kind in self._subscribers

    def tell(self, event: object) -> None:
        """Tell an event to whoever has subscribed to its kind."""
        for hear in self._subscribers.get(type(event), ()):
            hear(event)
