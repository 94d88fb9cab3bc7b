"""People in physics: they are where they say, the laser sees them, and bumps have a force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.actors import crowd_of
from momantu_worlds.sapien.crowd import Crowd
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Actor, Body, Box, Episode, Part
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Transform
from momantu_bt.messages import BaseVelocity
from momantu_bt.world import WorldError

ANNA = Actor("anna", ((2.2, -3.0), (2.2, 3.0)), (0.8, 0.9), (0.0, 0.5))
BLOCK = Body("block", "crate", Transform((-2.0, 3.0, 0.5)), (Part(Box((2.0, 2.0, 1.0))),))


def _episode(*actors: Actor) -> Episode:
    plain = plain_episode(table=False)
    return replace(plain, bodies=(*plain.bodies, BLOCK), actors=actors)


def _simulated(*actors: Actor, seed: int = 0) -> tuple[Simulator, Crowd]:
    episode = _episode(*actors)
    simulator = Simulator(fetch(), episode, seed, render=False)
    return simulator, crowd_of(simulator, episode, seed)


def test_bodies_are_where_people_are_and_the_same_seed_is_the_same() -> None:
    states = []
    for _ in range(2):
        simulator, crowd = _simulated(ANNA)
        way = 0.0
        before = crowd.walkers[0].pose
        for _ in range(100):
            simulator.step()
            walker = crowd.walkers[0]
            body = simulator.truth.pose("anna")
            assert np.hypot(*(body.position[:2] - walker.at)) < 1e-3
            way, before = way + before.distance_to(walker.pose), walker.pose
        assert way > 2.0
        states.append((simulator.state_bytes(), simulator.truth.pose("anna").position.tobytes()))
        simulator.close()
    assert states[0] == states[1]


def test_the_laser_sees_who_passes() -> None:
    simulator, crowd = _simulated(ANNA)
    name = fetch().laser()[0]
    nearest = []
    for _ in range(160):
        simulator.step()
        if abs(crowd.walkers[0].at[1]) < 0.3:
            nearest.append(float(simulator.robot.read(name).ranges.min()))
    simulator.close()
    assert nearest
    assert min(nearest) < 2.3


def test_a_robot_that_drives_into_somebody_feels_it_and_the_force_is_told() -> None:
    simulator, crowd = _simulated(ANNA)
    simulator.truth.watch_contacts()
    person = crowd.walkers[0]
    person.advance = lambda now, dt, seen: None  # type: ignore[method-assign]
    x, y = person.at
    strongest = 0.0
    turn = float(np.arctan2(y, x))
    for k in range(400):
        pose = simulator.truth.base()
        off = float(np.clip(turn - pose.yaw, -0.7, 0.7))
        simulator.robot.command("base", BaseVelocity(0.5 if abs(off) < 0.05 else 0.0, 2.0 * off))
        simulator.step()
        for contact in simulator.truth.contacts():
            if contact.second == "anna":
                strongest = max(strongest, contact.force)
        if strongest > 0.0 and k % 10 == 0:
            break
    moved = simulator.truth.pose("anna").position[:2]
    simulator.close()
    assert strongest > 1.0
    assert np.hypot(*(moved - (x, y))) < 1e-3


@pytest.mark.parametrize(
    ("stops", "says"),
    [
        (((2.0, 0.0), (-2.0, 3.0)), "cannot stand at its stop 2, (-2, 3)"),
        (((0.5, 0.0), (0.0, 0.5)), "has no stop to begin at: each is within 1.5 m of the robot"),
    ],
)
def test_where_nobody_can_stand_is_told(stops: tuple[tuple[float, float], ...], says: str) -> None:
    with pytest.raises(WorldError) as caught:
        _simulated(replace(ANNA, stops=stops))
    assert says in str(caught.value)
