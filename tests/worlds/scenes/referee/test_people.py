"""The referee tells who was pushed, how hard, and whether the robot or the person came."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest
from momantu_worlds.scenes.referee.people import MOST_PUSH, PushedPeople


@dataclass
class Touch:
    first: str
    second: str
    force: float


class Truth:
    robot_links = frozenset({"base_link", "hand"})

    def __init__(self) -> None:
        self.speed, self.joint = (0.0, 0.0), 0.0

    def base_speed(self) -> tuple[float, float]:
        return self.speed

    def joint_speeds(self) -> dict[str, Any]:
        return {"elbow": type("Speed", (), {"speed": self.joint, "linear": False})()}


@pytest.mark.parametrize(
    ("base", "joint"), [((0.3, 0.0), 0.0), ((0.0, 0.2), 0.0), ((0.0, 0.0), 0.3)]
)
def test_a_push_of_the_moving_robot_is_an_incident(base: tuple[float, float], joint: float) -> None:
    truth = Truth()
    people = PushedPeople(truth)  # type: ignore[arg-type]
    people.watch("anna")
    truth.speed, truth.joint = base, joint
    people.observe(1.0, [Touch("base_link", "anna", 10.0)])
    assert people.incidents() == []
    people.observe(1.2, [Touch("base_link", "anna", MOST_PUSH + 5.0)])
    people.observe(1.4, [Touch("base_link", "anna", MOST_PUSH + 9.0)])
    people.observe(3.0, [Touch("hand", "anna", MOST_PUSH + 1.0), Touch("hand", "can", 99.0)])
    told = [(each.time, each.kind, each.value) for each in people.incidents()]
    assert told == [(1.2, "person", MOST_PUSH + 9.0), (3.0, "person", MOST_PUSH + 1.0)]
    assert "base_link pushed the person anna with 34 N" in people.incidents()[0].sentence
    assert (people.pushed, people.met) == (MOST_PUSH + 9.0, 0.0)


def test_who_walks_into_a_standing_robot_was_not_pushed() -> None:
    people = PushedPeople(Truth())  # type: ignore[arg-type]
    people.watch("anna")
    people.observe(1.0, [Touch("base_link", "anna", 300.0)])
    assert (people.pushed, people.met, people.incidents()) == (0.0, 300.0, [])
