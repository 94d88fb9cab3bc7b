"""Faults in worlds that lack what the four rooms have: refused in words, never a crash."""

from __future__ import annotations

import json

import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.faults.rows import ROWS, possible, prepare
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import item_top
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.loading import draw_episode
from momantu_worlds.scenes.referee.hand import hand_of
from momantu_worlds.scenes.referee.referee import Referee

from momantu_bt.fault import FaultError

BARE = {"momantu_world": 1, "name": "bare", "start": {"at": [1.5, 1.5, 0], "turn": 0}}
ROOMS = {
    "rooms": {"a": {"corner": [0, 0], "size": [4, 3]}, "b": {"corner": [4, 0], "size": [4, 3]}},
    "doors": {"between": {"at": [4, 1.5], "width": 1}},
    "tables": {
        "desk": {"at": [2, 2.5, "-90 deg"], "size": [0.7, 1.4, 0.7], "sides": [0]},
        "other": {"at": [7, 1.5, "180 deg"], "size": [0.7, 1.4, 0.7], "sides": [0]},
    },
    "objects": {"cola": {"kind": "can", "on": "desk", "at": [0, 0]}},
}
GOAL = {"goal": {"item": "cola", "on": "other"}}
USUAL = {
    "robot.kidnapped": {"distance": 0.1, "turn": 0.5},
    "object.moved": {"distance": 0.1},
    "place.occupied": {"free": 1},
    "tag.wrong_id": {"id": 7},
}


def stage_in(world) -> Stage:
    episode, robot = draw_episode(world, 0), fetch()
    simulator = Simulator(robot, episode, 0, render=False)
    judged = episode.goal is not None
    referee = Referee(episode, simulator.truth, hand_of(robot)) if judged else None
    made = Stage(simulator, episode, robot, 0, referee)
    simulator.step()
    if referee is not None:
        referee.observe(simulator.now())
    return made


@pytest.fixture
def stage_of(tmp_path):
    def stage(**parts) -> Stage:
        path = tmp_path / "world.yaml"
        path.write_text(json.dumps({**BARE, **parts}), encoding="utf-8")
        return stage_in(path)

    return stage


def begun(stage, fault):
    """What becomes of each possible fault: its reason, or nothing where it began."""
    said = {}
    for name in possible(stage):
        if name.startswith("camera."):
            continue
        effect = prepare(stage, fault(name, **USUAL.get(name, {})))
        try:
            effect.begin()
        except FaultError as error:
            said[name] = str(error)
        else:
            said[name] = ""
        effect.end()
    return said


def test_a_bare_floor_has_what_needs_nothing(stage_of, fault):
    stage = stage_of()
    assert begun(stage, fault) == dict.fromkeys(
        ("robot.kidnapped", "person.in_way", "person.follows"), ""
    )
    for name in set(ROWS) - set(possible(stage)):
        with pytest.raises(FaultError):
            prepare(stage, fault(name))


def test_a_goal_without_a_marker_has_all_but_what_the_marker_suffers(stage_of, fault):
    stage = stage_of(**ROOMS, **GOAL)
    lacking = set(ROWS) - set(possible(stage))
    assert lacking == {"place.occupied", "tag.covered", "tag.wrong_id"}
    for name in lacking:
        with pytest.raises(FaultError, match="the goal of 'bare' names no marker"):
            prepare(stage, fault(name, **USUAL.get(name, {})))
    said = begun(stage, fault)
    assert said.pop("object.lost").endswith("cola is not in the hand now")
    assert set(said.values()) == {""}


def test_between_the_boards_of_a_rack_is_room(fault):
    stage = stage_in("warehouse")
    top = item_top(stage)
    for name in ("object.moved", "object.knocked_over"):
        prepare(stage, fault(name, **USUAL.get(name, {}))).begin()
        assert item_top(stage).name == top.name
        rack = [p for p in stage.part_prisms(top.name, stage.goal.item) if p.top > 0.1]
        assert stage.item_prism().clear_of(rack, 0.0)


def test_a_door_below_a_lintel_is_blocked_by_a_crate_as_wide_as_it(stage_of, fault):
    stage = stage_of(**ROOMS, **GOAL)
    effect = prepare(stage, fault("doorway.blocked"))
    effect.begin()
    (crate,) = stage.simulator.added
    x, y, _ = crate.map_from_body.position
    assert (x, y) == pytest.approx((4.0, 1.5), abs=0.03)
    width = max(part.geometry.size[1] for part in crate.parts)
    assert width == pytest.approx(0.9, abs=0.05)
    effect.end()


def test_the_referee_judges_a_goal_without_a_marker(stage_of):
    stage = stage_of(**ROOMS, **GOAL)
    verdict = stage.referee.verdict()
    assert not verdict.success
    assert verdict.measures["distance"] == 0.0
    assert any("not whole on the top of other" in sentence for sentence in verdict.unmet)
    assert not any(" from " in sentence for sentence in verdict.unmet)
