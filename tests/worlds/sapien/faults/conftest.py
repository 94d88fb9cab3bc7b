"""Stages to break things on: one that sees, one without cameras for each seed, one that holds."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.faults.rows import prepare
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import table_top
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Cylinder, Part
from momantu_worlds.scenes.loading import draw_episode
from momantu_worlds.scenes.referee.hand import hand_of
from momantu_worlds.scenes.referee.referee import Referee

from momantu_bt.fault import Fault
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import GripperCommand, JointPositions
from tests.worlds.origins import with_foot

FETCH = fetch()
ARM = FETCH.actuators["arm"].joints
LOW = {**FETCH.named_poses["carry"], "torso_lift_joint": 0.2}
HEAD_TILT = 0.6
"""rad downwards; both tables are in view."""
AWAY = 0.8
"""m from a table's edge to the middle of a base that looks at it."""

Happening = Callable[..., AbstractContextManager[None]]
Steps = Callable[..., None]


def new_stage(seed: int, *, render: bool = False, foot: Transform | None = None) -> Stage:
    """foot: of the item in its frame; None: its origin, as the catalogue has it."""
    episode = draw_episode("four_rooms", seed)
    if foot is not None:
        can = with_foot(episode.body("can"), foot)
        bodies = tuple(can if body.name == "can" else body for body in episode.bodies)
        episode = dataclasses.replace(episode, bodies=bodies)
    simulator = Simulator(FETCH, episode, seed, render=render)
    return judged(simulator, episode, seed)


def judged(simulator: Simulator, episode, seed: int) -> Stage:
    referee = Referee(episode, simulator.truth, hand_of(FETCH))
    stage = Stage(simulator, episode, FETCH, seed, referee)
    step(stage)
    return stage


def step(stage: Stage, ticks: int = 1, **goals: object) -> None:
    for _ in range(ticks):
        for actuator, goal in goals.items():
            stage.simulator.robot.command(actuator, goal)  # type: ignore[arg-type]
        stage.simulator.step()
        assert stage.referee is not None
        stage.referee.observe(stage.simulator.now())


def fault(name: str, **parameters: float) -> Fault:
    component, _, mode = name.partition(".")
    return Fault(component, mode, None, parameters)


@contextmanager
def _happening(stage: Stage, name: str, **parameters: float) -> Iterator[None]:
    """A fault from its beginning to its end; afterwards item and base are where they were."""
    item, base = stage.item_pose(), stage.base()
    effect = prepare(stage, fault(name, **parameters))
    effect.begin()
    try:
        yield
    finally:
        effect.end()
        stage.move_item(item)
        stage.simulator.robot.carry(base)
        step(stage)


def stand_before(stage: Stage, table: str, body: str) -> None:
    """Set the robot down where it looks at a body from a table's preferred side, head bent."""
    top = table_top(stage, table)
    along = top.size[0] / 2 if abs(math.cos(top.side)) > 0.5 else top.size[1] / 2
    cos, sin = math.cos(top.side), math.sin(top.side)
    thing = top.map_from_top.inverse().apply(stage.simulator.truth.pose(body).position)
    out, aside = along + AWAY, thing[1] * cos - thing[0] * sin
    own = Pose2D(out * cos - aside * sin, out * sin + aside * cos, top.side + math.pi)
    stage.simulator.robot.carry(Pose2D.from_transform(top.map_from_top) @ own)
    step(stage, 30, head=JointPositions(("head_pan_joint", "head_tilt_joint"), (0.0, HEAD_TILT)))


@pytest.fixture(name="happening", scope="session")
def happening_of() -> Happening:
    """`happening(stage, name, **parameters)`: the fault lasts as long as the `with` block."""
    return _happening


@pytest.fixture(name="fault", scope="session")
def fault_of() -> Callable[..., Fault]:
    """`fault(name, **parameters)`."""
    return fault


@pytest.fixture(name="step", scope="session")
def step_of() -> Steps:
    """`step(stage, ticks, **goals)`."""
    return step


@pytest.fixture(name="stand_before", scope="session")
def stand_before_of() -> Callable[[Stage, str, str], None]:
    """`stand_before(stage, table, body)`."""
    return stand_before


@pytest.fixture(scope="session")
def blind() -> Callable[[int], Stage]:
    """`blind(seed)`: a stage of that seed without cameras; one at a time is kept."""
    kept: dict[int, Stage] = {}

    def of(seed: int) -> Stage:
        if seed not in kept:
            kept.clear()
            kept[seed] = new_stage(seed)
        return kept[seed]

    return of


@pytest.fixture(name="new_stage", scope="session")
def new_stage_of() -> Callable[..., Stage]:
    """`new_stage(seed, render=False, foot=None)`: another stage."""
    return new_stage


@pytest.fixture(scope="module")
def seeing() -> Stage:
    """A stage with cameras."""
    return new_stage(3, render=True)


@pytest.fixture(scope="module")
def carrying() -> Stage:
    """The robot has lifted the item from a post, 0.15 m above it."""
    return new_carrying()


@pytest.fixture(name="new_carrying", scope="session")
def new_carrying_of() -> Callable[[], Stage]:
    """`new_carrying()`: another stage like `carrying`."""
    return new_carrying


def new_carrying() -> Stage:
    episode = draw_episode("four_rooms", 3)
    hand = episode.start.transform() @ FETCH.kinematics().base_from_frame("gripper_link", LOW)
    x, y, z = hand.position
    height = 0.13
    foot = Transform((x, y, z - height / 2), episode.start.transform().quaternion)
    item = dataclasses.replace(episode.body("can"), map_from_body=foot)
    post = Part(Cylinder(0.03, 0.1), Transform((0, 0, -0.05)))
    bodies = tuple(item if body.name == "can" else body for body in episode.bodies)
    episode = dataclasses.replace(episode, bodies=(*bodies, Body("post", "post", foot, (post,))))
    simulator = Simulator(FETCH, episode, 3, render=False, pose=LOW)
    stage = judged(simulator, episode, 3)
    step(stage, 25, gripper=GripperCommand(0.0, 40.0))
    lifted = {**LOW, "torso_lift_joint": 0.35}
    step(stage, 45, arm=JointPositions(ARM, tuple(lifted[name] for name in ARM)))
    return stage
