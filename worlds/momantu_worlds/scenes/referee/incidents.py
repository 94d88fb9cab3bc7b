"""Incidents: dangerous events, whether or not a goal forbids them."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.world import Incident
from momantu_worlds.scenes.geometry.bodies import Body, Episode
from momantu_worlds.scenes.referee.drops import Drops
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce
from momantu_worlds.scenes.referee.hand import Hand
from momantu_worlds.scenes.referee.impacts import Impacts

LINEAR, ANGULAR = 0.02, 0.05
"""Speeds below which the robot is at rest, m/s and rad/s."""


class Incidents:
    """Checks for impacts and drops at every tick, and for motion on request."""

    def __init__(self, episode: Episode, truth: GroundTruth, hand: Hand) -> None:
        self._truth, self._hand = truth, hand
        self._impacts = Impacts(truth, hand)
        self._drops = Drops(episode, truth, hand)

    def observe(self, now: float, contacts: Sequence[TouchingForce]) -> None:
        """Record the contacts of the tick that ended at `now`, s."""
        self._impacts.observe(now, contacts)
        self._drops.observe(now, contacts)

    def relocated(self, name: str) -> None:
        """A fault moved a body: the robot did not drop it."""
        self._drops.relocated(name)

    def added(self, body: Body) -> None:
        """A body came into the world."""
        self._drops.added(body)

    def removed(self, name: str) -> None:
        """An added body has left the world."""
        self._drops.removed(name)

    def until(self, now: float) -> tuple[Incident, ...]:
        """All incidents in order of time, and what still moves at `now`, s, the end of the run."""
        found = [*self._impacts.incidents(), *self._drops.incidents]
        found += still_moving(self._truth, self._hand, now)
        return tuple(sorted(found, key=lambda incident: incident.time))


def still_moving(truth: GroundTruth, hand: Hand, now: float) -> list[Incident]:
    """An incident for the base and for each joint of arm and gripper that moves; value: speed."""
    linear, angular = truth.base_speed()
    speeds = [("the base", linear, True), ("the base", angular, False)]
    speeds += [
        (name, joint.speed, joint.linear)
        for name, joint in truth.joint_speeds().items()
        if name in hand.joints
    ]
    return [
        Incident(
            now,
            "moving",
            f"{what} still moves at {speed:.2f} {'m/s' if slides else 'rad/s'}",
            speed,
        )
        for what, speed, slides in speeds
        if speed > (LINEAR if slides else ANGULAR)
    ]
