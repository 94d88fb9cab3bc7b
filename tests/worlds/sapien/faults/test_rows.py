"""Which world faults there are, what they refuse, and that they are the same every time."""

from __future__ import annotations

import pytest
from momantu_worlds.fault_kinds import KINDS
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.faults.rows import ROWS, possible, prepare
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.simulated_world import SapienWorld
from momantu_worlds.testing import plain_episode

from momantu_bt.fault import FaultError, FaultyWorld
from momantu_bt.fault_kind import Where

BLIND = {
    "robot.kidnapped": {"distance": 1.0, "turn": 1.0},
    "doorway.blocked": {},
    "person.in_way": {},
    "person.in_doorway": {},
    "person.follows": {},
    "person.reaches_over": {},
    "object.moved": {"distance": 0.08},
    "object.knocked_over": {},
    "object.removed": {},
    "place.occupied": {"free": 1},
    "tag.covered": {},
    "tag.wrong_id": {"id": 7},
}
"""Faults that need no camera and nothing in the hand, with their usual parameters."""
OTHERS = {"camera.misses_object", "camera.phantom", "object.lost"}


def keeps_the_contract(world: SapienWorld) -> FaultyWorld:
    """Typed: the type checker proves that the protocol is kept."""
    return world


def test_the_listed_kinds_are_those_that_can_be_made():
    assert {kind.name: kind.place for kind in KINDS} == dict.fromkeys(ROWS, Where.WORLD)


def test_every_fault_is_possible_in_the_rooms_and_tested_here(blind):
    assert set(possible(blind(0))) == set(ROWS) == set(BLIND) | OTHERS


def test_a_world_without_goal_and_doorways_says_so(fault):
    episode = plain_episode()
    stage = Stage(Simulator(fetch(), episode, 0, render=False), episode, fetch(), 0, None)
    assert possible(stage) == ("robot.kidnapped", "person.in_way", "person.follows")
    with pytest.raises(FaultError, match="'plain' has no goal"):
        prepare(stage, fault("object.removed"))
    with pytest.raises(FaultError, match="'plain' has no doorways"):
        prepare(stage, fault("doorway.blocked"))


WRONG = [
    ("object.moved", {}, r"needs the parameter 'distance'"),
    ("object.moved", {"distance": 0.1, "speed": 1}, r"no parameter 'speed'; it has: distance"),
    ("object.moved", {"distance": 9.0}, r"distance is 9.0, expected a number from 0.01 to 2 m"),
    ("object.moved", {"distance": float("nan")}, r"expected a number"),
    ("object.moved", {"distance": True}, r"distance is True"),
    ("object.removed", {"distance": 0.1}, r"no parameter 'distance'; it has: none"),
    ("robot.kidnapped", {"distance": 1.0, "turn": 4.0}, r"turn is 4.0.*rad"),
    ("place.occupied", {"free": 1.5}, r"free is 1.5, expected a whole number from 0 to 4"),
    ("tag.wrong_id", {"id": "x"}, r"id is 'x'"),
    ("tag.wrong_id", {"id": 1}, r"1 is the id that the tag has"),
    ("camera.misses_object", {"frames": 3}, r"no camera"),
    ("world.ended", {}, r"no world fault 'world.ended'; there are: camera.misses_object"),
]


@pytest.mark.parametrize(("name", "parameters", "message"), WRONG)
def test_what_is_wrong_is_said_before_anything_happens(blind, fault, name, parameters, message):
    with pytest.raises(FaultError, match=message):
        prepare(blind(0), fault(name, **parameters))


def test_how_long_it_lasts_is_the_business_of_who_ends_it(blind, fault):
    effect = prepare(blind(0), fault("person.in_way", **{"for": 10.0}))
    effect.end()  # it has not begun: nothing to mend
    assert blind(0).simulator.added == ()


@pytest.mark.parametrize("name", BLIND)
@pytest.mark.parametrize("seed", [0, 2, 5])
def test_nothing_is_put_where_something_is(blind, happening, step, name, seed):
    stage = blind(seed)
    truth = stage.simulator.truth
    with happening(stage, name, **BLIND[name]):
        moving = {stage.goal.item, *stage.crowd.names}
        before = {b: truth.pose(b) for b in truth.bodies if b not in moving}
        step(stage, 4)
        for body, pose in before.items():
            assert abs(truth.pose(body).position - pose.position).max() < 2e-3, body
        assert not [c for c in truth.contacts() if c.first in truth.robot_links]
        assert truth.speed(stage.goal.item)[0] < 0.1
    assert not stage.simulator.added


@pytest.mark.parametrize("name", BLIND)
def test_the_same_seed_breaks_the_same_way(blind, happening, step, name):
    stage = blind(4)
    seen = []
    for _ in range(2):
        with happening(stage, name, **BLIND[name]):
            poses = [body.map_from_body for body in stage.simulator.added]
            seen.append((stage.item_pose(), stage.base(), poses))
    (item, base, poses), again = seen
    assert again[0].position == pytest.approx(item.position, abs=1e-4)
    assert again[1].distance_to(base) < 1e-4
    assert [p.position.tolist() for p in again[2]] == [
        pytest.approx(p.position.tolist(), abs=1e-3) for p in poses
    ]


def test_what_is_prepared_and_does_not_begin_changes_nothing(fault):
    episode = plain_episode()
    states = []
    for prepared in (False, True):
        simulator = Simulator(fetch(), episode, 0, render=False)
        stage = Stage(simulator, episode, fetch(), 0, None)
        if prepared:
            prepare(stage, fault("robot.kidnapped", **BLIND["robot.kidnapped"]))
            prepare(stage, fault("person.in_way"))
        for _ in range(5):
            simulator.step()
        states.append(simulator.state_bytes())
    assert states[0] == states[1]


def test_two_of_a_kind_have_names_of_their_own(blind, fault):
    stage = blind(4)
    effects = [prepare(stage, fault("person.in_way")) for _ in range(2)]
    for effect in effects:
        effect.begin()
    assert [body.name for body in stage.simulator.added] == ["person", "person_2"]
    for effect in effects:
        effect.end()
        effect.end()
    assert stage.simulator.added == ()
