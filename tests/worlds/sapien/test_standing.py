"""What is let go leaning comes to stand, what lies keeps lying: contacts give no energy."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Hull, Part
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Array, Transform
from momantu_bt.world import TICK

COUNT = 40
FIRST = 5.0
"""m from the robot to the first body, behind the wall; rows of ten, half a metre apart."""
MIDDLE = Transform((FIRST + 2.25, 0.75, 0.35))
CORNERS = np.array(list(product((-3.0, 3.0), (-1.5, 1.5), (-0.35, 0.35))))
TOPS = {"box": Box((6.0, 3.0, 0.7)), "disc": Cylinder(3.0, 0.7), "hull": Hull(CORNERS)}
CAN = (0.035, 0.13, 0.4, 6.0)
BOTTLE = (0.03, 0.25, 0.6, 3.0)
PEN_POT = (0.02, 0.1, 0.1, 5.0)
"""Radius and height, m; mass, kg; by how far it leans at most, degrees: a quarter of falling."""


def cylinder(name: str, radius: float, height: float, mass: float, pose: Transform) -> Body:
    part = Part(Cylinder(radius, height), color=(0.5, 0.5, 0.5))
    return Body(name, "thing", pose, (part,), static=False, mass=mass, friction=0.8)


def after(
    thing: tuple[float, float, float], leans: list[float], seconds: float, top: str = "box"
) -> Array:
    """Where the axes (n, 3) of cylinders that were let go on a table point to, and then still."""
    radius, height, mass = thing
    table = Body("slab", "table", MIDDLE, (Part(TOPS[top]),), friction=0.8)
    random = np.random.default_rng(0)
    bodies = []
    for i, lean in enumerate(leans):
        turn = Transform.from_rpy((0, 0, 0), (0, lean, 0)).quaternion
        around = Transform.from_rpy((0, 0, 0), (0, 0, random.uniform(-math.pi, math.pi)))
        z = 0.7 + height / 2 * abs(math.cos(lean)) + radius * abs(math.sin(lean)) + 5e-4
        at = Transform((FIRST + 0.5 * (i % 10), 0.5 * (i // 10), z))
        own = Transform.from_rpy((0, 0, 0), (0, 0, random.uniform(-math.pi, math.pi)))
        pose = at @ around @ Transform((0, 0, 0), turn) @ own
        bodies.append(cylinder(f"thing_{i}", radius, height, mass, pose))
    plain = plain_episode()
    episode = replace(plain, bodies=(*plain.bodies, table, *bodies))
    simulator = Simulator(fetch(), episode, 0, render=False)
    try:
        for _ in range(round(seconds / TICK)):
            simulator.step()
        poses = [simulator.truth.pose(body.name) for body in bodies]
        simulator.step()
        later = [simulator.truth.pose(body.name) for body in bodies]
        moved = [np.linalg.norm(a.position - b.position) for a, b in zip(poses, later, strict=True)]
        assert max(moved) < 1e-4
        return np.array([pose.rotation[:, 2] for pose in later])
    finally:
        simulator.close()


@pytest.mark.parametrize("top", TOPS)
@pytest.mark.parametrize("thing", [CAN, BOTTLE, PEN_POT])
def test_what_is_let_go_leaning_comes_to_stand(
    thing: tuple[float, float, float, float], top: str
) -> None:
    radius, height, mass, most = thing
    leans = np.radians(np.linspace(-most, most, COUNT)).tolist()
    upright = after((radius, height, mass), leans, 6.0, top)[:, 2]
    assert np.degrees(np.arccos(np.minimum(upright, 1.0))).max() < 0.5


@pytest.mark.parametrize("thing", [CAN, BOTTLE, PEN_POT])
def test_what_lies_on_its_round_side_keeps_lying(
    thing: tuple[float, float, float, float],
) -> None:
    radius, height, mass, _ = thing
    upright = after((radius, height, mass), [math.pi / 2] * COUNT, 4.0)[:, 2]
    assert np.abs(upright).max() < 0.01
