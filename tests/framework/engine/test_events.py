"""One stream of events for everybody who watches a run."""

from __future__ import annotations

import signal
from typing import NamedTuple

from momantu_bt.engine.events import Events
from momantu_bt.engine.executor import NodeStarting, Stepping, Ticked
from momantu_bt.engine.outside import SkillEnded, SkillStepped
from momantu_bt.skill import In, Run, Skill


class One(NamedTuple):
    value: int


class Other(NamedTuple):
    value: int


class Pause(Skill):
    """Waits for some ticks."""

    ticks: int = In(doc="how many")

    def run(self, robot) -> Run:
        for _ in range(self.ticks):
            yield "waits"


TREE = "trees:\n  Main:\n    - pause: 2\n    - pause: 1\n"


def test_events_reach_those_who_subscribed_to_their_kind_in_turn() -> None:
    events, heard = Events(), []
    events.subscribe(One, lambda event: heard.append(("first", event.value)))
    events.subscribe(One, lambda event: heard.append(("second", event.value)))
    events.publish(One(1))
    events.publish(Other(2))
    assert heard == [("first", 1), ("second", 1)]
    assert events.has_subscribers(One)
    assert not events.has_subscribers(Other)


def test_a_run_tells_starts_steps_and_ends_in_order_and_is_the_same_unheard(run_yaml) -> None:
    told: list[str] = []

    def watch(run):
        for kind in (NodeStarting, SkillStepped, SkillEnded):
            run.context.events.subscribe(
                kind, lambda event: told.append(f"{type(event).__name__} {event[0].name}")
            )
        run.context.events.subscribe(Stepping, lambda event: told.append(f"{event}"))
        run.context.events.subscribe(Ticked, lambda event: told.append("Ticked"))
        return []

    report = run_yaml(TREE, Pause, watch=watch)
    assert told[:6] == [
        "Stepping(settling=False)",
        "NodeStarting sequence",
        "NodeStarting pause",
        "SkillStepped pause",
        "Ticked",
        "Stepping(settling=False)",
    ]
    assert told.count("SkillEnded pause") == 2
    assert told[-1] == "Ticked"
    assert told[-2] == "Stepping(settling=True)"
    assert report.fingerprint == run_yaml(TREE, Pause).fingerprint


def test_who_interrupts_at_a_start_holds_the_tree_there(run_yaml) -> None:
    steps: list[SkillStepped] = []

    def interrupt(event: NodeStarting) -> None:
        if event.node.name == "pause":
            signal.raise_signal(signal.SIGINT)

    def watch(run):
        run.context.events.subscribe(NodeStarting, interrupt)
        run.context.events.subscribe(SkillStepped, steps.append)
        return []

    report = run_yaml(TREE, Pause, watch=watch)
    assert report.status == "INTERRUPTED"
    assert steps == []
