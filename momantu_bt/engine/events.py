"""The events of a run: each one is passed to its subscribers at the moment it happens.

Kinds of events are defined beside their publishers: `Ticked`, `Stepping` and `NodeStarting` in
`executor.py`, `SkillStepped`, `SkillEnded`, `Drawn` and `Answered` in `outside.py`, `Remarked` in
`context.py`, `SensorRead` in `actuators.py`. A subscriber only observes: the run is the same
without it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

E = TypeVar("E")


class Events:
    """The stream of one run. Events of one kind reach their subscribers in order of subscription.

    An exception in a subscriber ends the run. A subscriber that must not do so catches its own.
    """

    def __init__(self) -> None:
        self._subscribers: dict[type, list[Callable[[Any], None]]] = {}

    def subscribe(self, kind: type[E], callback: Callable[[E], None]) -> None:
        """Call `callback` with each event of a kind from now on."""
        self._subscribers.setdefault(kind, []).append(callback)

    def has_subscribers(self, kind: type) -> bool:
        """Whether a kind of events has subscribers."""
        return kind in self._subscribers

    def publish(self, event: object) -> None:
        """Call the subscribers of the event's kind."""
        for callback in self._subscribers.get(type(event), ()):
            callback(event)
