"""Incidents by rule, on ground truth that a test writes down."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.truth import JointSpeed
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Episode, Part
from momantu_worlds.scenes.referee.hand import Hand
from momantu_worlds.scenes.referee.incidents import Incidents

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.world import TICK, Incident, Site

HAND = Hand("palm", frozenset({"left", "right"}), frozenset({"elbow", "lift"}))
CAN = Part(Cylinder(0.035, 0.13), Transform((0, 0, 0.065)))
GRIPPED = [("left", "can"), ("right", "can")]


@dataclass(frozen=True)
class Touch:
    first: str
    second: str
    force: float = 20.0


@dataclass
class FakeTruth:
    """A can above a floor at z = 0."""

    touches: list[Touch] = field(default_factory=list)
    can: Transform = field(default_factory=Transform)
    base: tuple[float, float] = (0.0, 0.0)
    joints: dict[str, JointSpeed] = field(default_factory=dict)
    robot_links: frozenset[str] = frozenset({"palm", "left", "right", "base"})

    def pose(self, body: str) -> Transform:
        return self.can

    def link(self, name: str) -> Transform:
        return Transform()

    def watch_contacts(self) -> None:
        """They are always there."""

    def contacts(self) -> list[Touch]:
        return self.touches

    def height_below(self, body: str, points: Array) -> tuple[float, str]:
        assert body == "can"
        return float(points[:, 2].min()), "floor"

    def base_speed(self) -> tuple[float, float]:
        return self.base

    def joint_speeds(self) -> dict[str, JointSpeed]:
        return self.joints


def watching(truth: FakeTruth) -> Incidents:
    bodies = (
        Body("can", "can", Transform(), (CAN,), static=False, mass=0.4),
        Body("table", "table", Transform(), (Part(Box((1, 1, 1))),)),
    )
    light = (0.0, 0.0, 0.0)
    episode = Episode("test", 0, bodies, Pose2D(0, 0), light, (), (), Site("test"))
    return Incidents(episode, truth, HAND)


def play(truth: FakeTruth, ticks: list[list[Touch]]) -> list[Incident]:
    watched = watching(truth)
    for number, touches in enumerate(ticks, 1):
        truth.touches = touches
        watched.observe(number * TICK, truth.touches)
    return list(watched.until(len(ticks) * TICK))


def grips(*pairs: tuple[str, str]) -> list[Touch]:
    return [Touch(*pair) for pair in pairs]


def blows(*forces: float, link: str = "base", thing: str = "table") -> list[list[Touch]]:
    return [[Touch(link, thing, force)] if force else [] for force in forces]


def test_each_blow_is_told_once_with_its_first_time_and_largest_force():
    pause = [0.0] * 12
    found = play(FakeTruth(), blows(10, 160, 0, 240, 90, *pause, 170))
    assert [(i.kind, round(i.time, 2), i.value) for i in found] == [
        ("force", 0.1, 240),
        ("force", 0.9, 170),
    ]
    assert found[0].sentence == "base pushed table with 240 N"


@given(st.lists(st.floats(0, 150), max_size=30))
def test_up_to_the_limit_nothing_is_told(forces):
    assert play(FakeTruth(), blows(*forces)) == []


@pytest.mark.parametrize(
    ("touches", "told"),
    [
        ([Touch("palm", "can", 200)], True),
        ([Touch("left", "can", 200)], True),
        ([Touch("left", "can", 200), Touch("right", "can", 200)], False),
        ([Touch("left", "can", 200), Touch("right", "table", 20)], True),
        ([Touch("base", "palm", 900)], False),
        ([Touch("can", "table", 900)], False),
    ],
)
def test_squeezing_and_what_others_do_is_no_blow(touches, told):
    assert bool(play(FakeTruth(), [touches])) is told


def dropped(truth: FakeTruth, ticks: list[list[Touch]]) -> list[Incident]:
    return [i for i in play(truth, ticks) if i.kind == "dropped"]


HELD = grips(*GRIPPED)


def test_what_leaves_the_hand_is_told_with_its_height_and_last_touch():
    truth = FakeTruth(can=Transform((0, 0, 0.31)))
    (drop,) = dropped(truth, [HELD, HELD, [], [], []])
    assert (drop.value, drop.time) == (pytest.approx(0.31), pytest.approx(2 * TICK))
    assert drop.sentence == "can left the hand 0.31 m above floor"


@given(st.floats(0.0, 0.6))
def test_it_depends_on_the_height_alone(height):
    truth = FakeTruth(can=Transform((0, 0, height)))
    assert bool(dropped(truth, [HELD, [], [], []])) is (height > 0.03)


HIGH = Transform((0, 0, 0.5))
NO_DROPS = {
    "still held": [HELD] * 5,
    "one tick without a touch": [HELD, [], HELD, [], HELD],
    "touched by one finger alone": [grips(("left", "can")), [], []],
    "touched by the palm": [grips(("palm", "can")), [], []],
    "gripped where it stands": [[*HELD, Touch("can", "table")], [], []],
    "something else": [grips(("left", "table"), ("right", "table")), [], []],
}


@pytest.mark.parametrize("ticks", NO_DROPS.values(), ids=NO_DROPS)
def test_no_drop(ticks):
    assert dropped(FakeTruth(can=HIGH), ticks) == []


def test_brushing_something_while_it_is_carried_does_not_hide_the_drop():
    assert dropped(FakeTruth(can=HIGH), [HELD, [*HELD, Touch("can", "table")], [], [], []])


def test_what_is_taken_is_not_dropped_and_what_is_added_can_be():
    truth = FakeTruth(can=HIGH)
    watched = watching(truth)
    truth.touches = HELD
    watched.observe(TICK, truth.touches)
    watched.relocated("can")
    truth.touches = []
    for tick in range(2, 6):
        watched.observe(tick * TICK, truth.touches)
    assert watched.until(1.0) == ()
    watched.removed("can")
    watched.added(Body("can", "box", Transform(), (CAN,), static=False))
    for tick, touches in enumerate([HELD, [], [], []], 6):
        truth.touches = touches
        watched.observe(tick * TICK, truth.touches)
    assert len(watched.until(1.0)) == 1


@pytest.mark.parametrize(
    ("truth", "sentences"),
    [
        (FakeTruth(base=(0.02, 0.05)), []),
        (FakeTruth(base=(0.03, 0.0)), ["the base still moves at 0.03 m/s"]),
        (FakeTruth(base=(0.0, 0.06)), ["the base still moves at 0.06 rad/s"]),
        (
            FakeTruth(joints={"elbow": JointSpeed(0.04, False), "lift": JointSpeed(0.04, True)}),
            ["lift still moves at 0.04 m/s"],
        ),
        (FakeTruth(joints={"neck": JointSpeed(9.0, False)}), []),
    ],
)
def test_what_moves_at_the_end_is_told_at_the_end(truth, sentences):
    found = watching(truth).until(7.0)
    assert [i.sentence for i in found] == sentences
    assert all((i.kind, i.time) == ("moving", 7.0) for i in found)


def test_all_are_in_the_order_of_time():
    truth = FakeTruth(can=HIGH, base=(1.0, 0.0))
    found = play(truth, [HELD, [], [], [Touch("base", "table", 300)]])
    assert [i.kind for i in found] == ["dropped", "force", "moving"]
