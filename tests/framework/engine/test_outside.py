"""What came from outside is kept in its order, and keeping it changes nothing."""

from __future__ import annotations

from momantu_bt.engine.outside import PERSON, POSITION, Refused
from momantu_bt.record.outside_log import OutsideLog
from momantu_bt.service import Service
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill

TREE = """
trees:
  Main:
    - ask: {question: "Which?", answer: $said}
    - parallel_all:
        - count: {to: 2, at: $at, last: $last}
        - wait: 1 s
          distance_controller: {distance: 1 m, global_frame: nowhere}
          force: success
    - script: "$seen := $@localization.x"
    - count: {to: 9, at: $at, last: $last}
"""


class Localization(Service):
    """Publishes where the robot is."""

    rate = 20.0
    publishes = {"x": float}

    def start(self, context):
        self.x = 0.0

    def update(self, robot, now):
        self.x = now

    def published(self):
        return {"x": self.x}


class Count(Skill):
    """Counts up, a number a tick; fails beyond five."""

    to: int = In(doc="how far")
    at: int = Out(doc="how far it is", live=True)
    last: int = Out(doc="how far it came")
    failures = {"TOO_FAR": "there are no more numbers"}
    localization: Localization = Needs()

    def run(self, robot) -> Run:
        for number in range(1, self.to + 1):
            self.at = number
            if number > 3:
                raise Failure("TOO_FAR", "it ends at three")
            yield f"at {number}"
        self.last = self.at


class Keeper:
    """An observer that keeps all that is heard, tick by tick."""

    def __init__(self, run):
        self.log = OutsideLog(run.context.events)
        self.steps, self.reads, self.failures = [], [], []

    def ticked(self, run):
        self.steps.append([(s.status.value, s.phase, dict(s.outputs)) for s in self.log.steps])
        self.reads.append(list(self.log.reads))
        self.failures += [s.failure.code for s in self.log.steps if s.failure is not None]
        self.log.clear()

    def close(self):
        pass


def heard(run_yaml, watch=None):
    found = []

    def keep(run):
        found.append(Keeper(run))
        return found

    services = {"localization": Localization}
    report = run_yaml(TREE, Count, services=services, answers=["red"], watch=watch or keep)
    return report, found[0] if found else None


def test_steps_of_skills_are_kept_with_what_is_new_in_them(run_yaml):
    _, kept = heard(run_yaml)
    assert kept.steps[:3] == [
        [("RUNNING", "at 1", {"at": 1})],
        [("RUNNING", "at 2", {"at": 2})],
        [("SUCCESS", "at 2", {"last": 2}), ("RUNNING", "at 1", {"at": 1})],
    ]
    assert kept.steps[5] == [("FAILURE", "at 3", {"at": 4})]
    assert kept.failures == ["TOO_FAR"]


def test_answers_are_kept_whatever_they_are(run_yaml):
    _, kept = heard(run_yaml)
    said, refused = kept.reads[0]
    assert said == (PERSON, "red")
    assert refused[0] == POSITION
    assert isinstance(refused[1], Refused)
    assert refused[1].failure.code == "FRAME_UNKNOWN"
    keys, values = zip(*kept.reads[2], strict=True)
    assert set(keys) == {"localization"}
    assert all(set(value) == {"x"} for value in values)


def test_keeping_changes_nothing(run_yaml):
    kept, _ = heard(run_yaml)
    plain, _ = heard(run_yaml, watch=lambda run: [])
    assert kept.fingerprint == plain.fingerprint
    assert kept.failure.code == plain.failure.code == "TOO_FAR"
