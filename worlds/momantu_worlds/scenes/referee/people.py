"""People: how hard the robot pushes them, and who walked into whom."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from momantu_bt.world import Incident
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce

MOST_PUSH = 25.0
"""N; a robot that pushes somebody harder counts as dangerous: a sixth of what ISO/TS 15066 allows
where a body is clamped, as those who are pushed may fall."""
REST = 0.05
"""Speed below which base and joints count as standing, m/s and rad/s: then a person came."""
REBOUND = 0.5
"""A contact within this time after another one belongs to it, s."""


@dataclass(slots=True)
class _Push:
    begun: float
    last: float
    force: float


class PushedPeople:
    """The largest force on anybody while the robot moved, and while it stood, N; and incidents."""

    def __init__(self, truth: GroundTruth) -> None:
        self._truth = truth
        self.pushed = self.met = 0.0
        self._names: set[str] = set()
        self._pushes: dict[tuple[str, str], list[_Push]] = {}

    def watch(self, name: str) -> None:
        """Watch the body of one more person."""
        self._names.add(name)

    def observe(self, now: float, contacts: Iterable[TouchingForce]) -> None:
        """Record the contacts of the tick that ended at `now`, s."""
        links = self._truth.robot_links
        touched = [c for c in contacts if c.first in links and c.second in self._names]
        if not touched:
            return
        moves = self._robot_moves()
        for contact in touched:
            if not moves:
                self.met = max(self.met, contact.force)
                continue
            self.pushed = max(self.pushed, contact.force)
            if contact.force > MOST_PUSH:
                self._take(now, contact)

    def incidents(self) -> list[Incident]:
        """Each push that was too hard, by its start and its largest force; value: N."""
        return [
            Incident(
                push.begun,
                "person",
                f"{link} pushed the person {name} with {push.force:.0f} N",
                push.force,
            )
            for (link, name), pushes in self._pushes.items()
            for push in pushes
        ]

    def _robot_moves(self) -> bool:
        joints = self._truth.joint_speeds().values()
        return max(*self._truth.base_speed(), *(joint.speed for joint in joints)) > REST

    def _take(self, now: float, contact: TouchingForce) -> None:
        pushes = self._pushes.setdefault((contact.first, contact.second), [])
        if pushes and now - pushes[-1].last <= REBOUND:
            pushes[-1].last = now
            pushes[-1].force = max(pushes[-1].force, contact.force)
        else:
            pushes.append(_Push(now, now, contact.force))
