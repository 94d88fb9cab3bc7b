"""Episodes in physics: what is set up stays where it is, and the referee judges it rightly."""

import dataclasses

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.loading import draw_episode
from momantu_worlds.scenes.referee.hand import hand_of
from momantu_worlds.scenes.referee.referee import Referee

from momantu_bt.geometry import Transform
from momantu_bt.messages import BaseVelocity

FETCH = fetch()
HAND = hand_of(FETCH)
SIDEWAYS = 0.17
"""m; beside the tag's middle the can stands on no tag."""


def solved(seed: int) -> Episode:
    """An episode in which the can stands where it is to be brought."""
    episode = draw_episode("four_rooms", seed)
    tag = episode.body("tag").map_from_body.position
    top = next(p for p in episode.body("table_b").parts if p.body_from_part.position[2] > 0.3)
    height = float(top.body_from_part.position[2]) + top.geometry.size[2] / 2
    others = [b.map_from_body.position for b in episode.bodies if not b.static]
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    spots = [tag[:2] + SIDEWAYS * np.array([np.cos(a), np.sin(a)]) for a in angles]
    free = max(spots, key=lambda s: min(np.linalg.norm(s - o[:2]) for o in others))
    can = dataclasses.replace(
        episode.body("can"), map_from_body=Transform((*free.tolist(), height))
    )
    bodies = tuple(can if body.name == "can" else body for body in episode.bodies)
    return dataclasses.replace(episode, bodies=bodies)


def watched(episode: Episode, ticks: int, speed: float = 0.0) -> tuple[Referee, Simulator]:
    simulator = Simulator(FETCH, episode, 0, render=False)
    referee = Referee(episode, simulator.truth, HAND)
    for _ in range(ticks):
        simulator.robot.command("base", BaseVelocity(speed, 0.0))
        simulator.step()
        referee.observe(simulator.now())
    return referee, simulator


@pytest.mark.parametrize("seed", [3, 6])
def test_a_can_that_stands_beside_the_tag_is_success(seed):
    verdict = watched(solved(seed), 40)[0].verdict()
    assert verdict.success, verdict.unmet
    assert verdict.measures["others_shift"] < 0.001


def test_it_takes_a_second_to_be_still():
    verdict = watched(solved(3), 15)[0].verdict()
    assert verdict.unmet == ("can has been still for 0.75 s, less than 1.00 s",)


@pytest.mark.parametrize("seed", [0, 12])
def test_at_reset_nothing_moves_and_nothing_is_done(seed):
    verdict = watched(draw_episode("four_rooms", seed), 40)[0].verdict()
    assert not verdict.success
    assert verdict.measures["others_shift"] < 0.001
    assert verdict.measures["others_tilt"] < 0.01
    assert verdict.measures["force"] == 0.0
    assert "can also touches table_a" in verdict.unmet


def test_driving_into_something_is_a_bump():
    verdict = watched(draw_episode("four_rooms", 0), 160, speed=1.0)[0].verdict()
    assert verdict.measures["force"] > 150
    assert any("the robot pushed with" in sentence for sentence in verdict.unmet)


def test_the_referee_changes_nothing():
    episode = draw_episode("four_rooms", 5)
    judged = watched(episode, 30, speed=0.4)[1]
    alone = Simulator(FETCH, episode, 0, render=False)
    for _ in range(30):
        alone.robot.command("base", BaseVelocity(0.4, 0.0))
        alone.step()
    assert alone.state_bytes() == judged.state_bytes()
