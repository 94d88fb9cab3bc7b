"""The referee: whether the goal is met, by ground truth; it changes nothing.

It observes after every tick. Criteria for the end (upright or lying, on the top, beside the marker,
still, touched by nothing else, gripper away) are checked at the last tick, for each demand: see
`demand`.
Criteria for the whole run (no hard bump, no other object pushed or toppled) use the worst tick so
far, and the strictest of the demands. Dangerous events are reported in addition, whether or not the
goal forbids them: see `incidents`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from momantu_bt.geometry import Transform
from momantu_bt.world import Demanded, Verdict
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Goal
from momantu_worlds.scenes.referee.demand import ItemDemand, degrees, leaned, moved
from momantu_worlds.scenes.referee.ground_truth import GroundTruth, TouchingForce
from momantu_worlds.scenes.referee.hand import Hand
from momantu_worlds.scenes.referee.incidents import Incidents
from momantu_worlds.scenes.referee.people import PushedPeople


@dataclass(slots=True)
class Peak:
    """The largest value so far, and the name of what caused it."""

    value: float = 0.0
    what: str = ""

    def record(self, value: float, what: str) -> None:
        """Record a value; the largest counts."""
        if value > self.value:
            self.value, self.what = value, what


class Referee:
    """Judges one episode; the module's docstring lists the criteria."""

    def __init__(
        self,
        episode: Episode,
        truth: GroundTruth,
        hand: Hand,
        people: frozenset[str] = frozenset(),
    ) -> None:
        """Watch from the next tick on. Without a goal, it only reports dangerous events.

        people: names of bodies that are people.
        """
        self._place, self._truth, self._gripper = episode.goals_place, truth, hand.gripper
        self._demands = [ItemDemand(episode, goal, truth) for goal in episode.goals]
        self._items = frozenset(goal.item for goal in episode.goals)
        self._others = {
            body.name: body.map_from_body
            for body in episode.bodies
            if not body.static and body.name not in self._items
        }
        self._poses: dict[str, Transform] = {}
        self._shift, self._tilt, self._bump = Peak(), Peak(), Peak()
        self._now = 0.0
        self._incidents = Incidents(episode, truth, hand)
        self._people: PushedPeople | None = None
        for name in sorted(people):
            self.admitted(name)
        truth.watch_contacts()

    def observe(self, now: float) -> None:
        """Observe the state at `now`, s; call it once after every tick."""
        self._now = now
        contacts = tuple(self._truth.contacts())
        touching = self._look_at_contacts(contacts)
        self._incidents.observe(now, contacts)
        if self._people is not None:
            self._people.observe(now, contacts)
        for demand in self._demands:
            demand.observe(now, frozenset(touching[demand.goal.item]))
        for name, before in self._others.items():
            pose = self._truth.pose(name)
            if self._poses.get(name) is pose:  # it has not moved since
                continue
            self._poses[name] = pose
            self._shift.record(moved(before, pose), name)
            self._tilt.record(leaned(before, pose), name)

    def relocated(self, name: str) -> None:
        """A fault moved a body, not the robot."""
        self._incidents.relocated(name)

    def added(self, body: Body) -> None:
        """A body was added; a loose one must not be pushed or toppled either."""
        if not body.static:
            self._others[body.name] = body.map_from_body
            self._poses.pop(body.name, None)
        self._incidents.added(body)

    def admitted(self, name: str) -> None:
        """Somebody came whom the robot must not push; name: of the body."""
        if self._people is None:
            self._people = PushedPeople(self._truth)
        self._people.watch(name)

    def removed(self, name: str) -> None:
        """An added body has left the world."""
        self._others.pop(name, None)
        self._incidents.removed(name)

    def verdict(self) -> Verdict:
        """The verdict on the last observed moment, with every unmet criterion and its numbers."""
        judged = [(demand, demand.measures(self._now, self._gripper)) for demand in self._demands]
        single = len(judged) == 1
        told: dict[str, float] = {}
        demands: list[Demanded] = []
        for demand, measures in judged:
            lead = "" if single else f"{demand.goal.item}."
            told |= {f"{lead}{name}": value for name, value in measures.items()}
            unmet = demand.unmet(measures)
            demands.append(Demanded(str(demand.goal), self._place, not unmet, unmet))
        told["others_shift"] = self._shift.value
        told["others_tilt"] = self._tilt.value
        told["force"] = self._bump.value
        peaks = {"others_shift": self._shift, "others_tilt": self._tilt, "force": self._bump}
        causes = {name: peak.what for name, peak in peaks.items() if peak.what}
        sentences = [sentence for demand in demands for sentence in demand.unmet]
        sentences += self._of_the_whole_run([demand.goal for demand in self._demands])
        success = not sentences if demands else None
        incidents = self._incidents.until(self._now)
        if self._people is not None:
            told |= {"person_pushed": self._people.pushed, "person_met": self._people.met}
            found = (*incidents, *self._people.incidents())
            incidents = tuple(sorted(found, key=lambda incident: incident.time))
        return Verdict(
            success,
            tuple(sentences),
            MappingProxyType(told),
            incidents,
            tuple(demands),
            MappingProxyType(causes),
        )

    def _look_at_contacts(self, contacts: Iterable[TouchingForce]) -> dict[str, set[str]]:
        """Record bumps; return what each item touches."""
        links, items = self._truth.robot_links, self._items
        touching: dict[str, set[str]] = {item: set() for item in items}
        for contact in contacts:
            first, second = contact.first, contact.second
            if first in items:
                touching[first].add(second)
            if second in items:
                touching[second].add(first)
            elif first in links and second not in links:
                self._bump.record(contact.force, f"{first} on {second}")
        return touching

    def _of_the_whole_run(self, goals: Sequence[Goal]) -> list[str]:
        """A sentence for each criterion of the whole run that is not met."""
        if not goals:
            return []
        tilted, shifted, force = self._tilt, self._shift, self._bump
        most = min(goal.max_force for goal in goals)
        criteria = (
            (
                tilted.value > min(goal.max_others_tilt for goal in goals),
                f"{tilted.what} was tilted by {degrees(tilted.value)}",
            ),
            (
                shifted.value > min(goal.max_others_shift for goal in goals),
                f"{shifted.what} was moved by {shifted.value:.2f} m",
            ),
            (
                force.value > most,
                f"the robot pushed with {force.value:.0f} N ({force.what}), more than {most:.0f} N",
            ),
        )
        return [sentence for bad, sentence in criteria if bad]
