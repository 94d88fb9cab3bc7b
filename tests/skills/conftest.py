"""The robots and scenes of `scenery`, as fixtures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.scene.service import PlanningSceneService

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose2D
from momantu_bt.robot import RobotDescription
from momantu_bt.service import ServiceContext
from momantu_bt.testing import (
    ScriptedRobot,
    ScriptedWorld,
    eye_in_hand_robot,
    scripted_site,
    small_robot,
)
from momantu_bt.testing.painting import Painter, Solid
from momantu_bt.world import Surface
from tests.skills.scenery.flat import (
    DESK,
    ROOMS,
    START,
    Box,
    Flat,
    FlatRobot,
    FlatScene,
    FlatSceneOf,
    write_map,
)
from tests.skills.scenery.onlooker import Onlooker, SeenScene
from tests.skills.scenery.table import SceneOf, Tabletop


@pytest.fixture
def flat(tmp_path: Path) -> Flat:
    """`flat(truth, believed=…, hidden=…, rooms=…)`: two rooms, a desk and a robot in them."""

    def build(
        truth: Pose2D = START,
        *,
        believed: Pose2D | None = None,
        hidden: Sequence[Box] = (),
        desk: Box = DESK,
        known: Sequence[Box] = (),
        seed: int = 0,
        drift: float = 0.02,
        description: RobotDescription | None = None,
        rooms: Sequence[Box] = ROOMS,
        span: Box = (-4.5, -3.5, 6.5, 3.5),
    ) -> ScriptedWorld:
        robot = FlatRobot(truth, seed, drift, description)
        robot.boxes = [*rooms, *known, desk, *hidden]
        site = scripted_site(
            map_file=write_map(tmp_path, [*rooms, *known, DESK], span),
            start=believed or truth,
            places={"left": Pose2D(-2.0, 1.5, 0.0), "right": Pose2D(2.2, -2.0, -1.0)},
            surfaces={
                "desk": Surface(Pose2D(3.9, 0.2, 0.0), (0.6, 1.2), 0.7, (math.pi, -math.pi / 2))
            },
        )
        return ScriptedWorld(robot, site)

    return build


@pytest.fixture
def flat_scene() -> FlatSceneOf:
    """`flat_scene(world)`: the planning scene that navigation needs."""
    return lambda world: FlatScene(world.robot.description.footprint)


@pytest.fixture
def seen_scene() -> type[SeenScene]:
    """`seen_scene(held=…, robot=…)`: the planning scene that perception needs."""
    return SeenScene


@pytest.fixture
def onlooker() -> Onlooker:
    """`onlooker(solids, …)`: a robot at the origin, its camera 1.15 m high; see `Painter`."""

    def build(solids: Sequence[Solid], **errors: Any) -> ScriptedRobot:
        description = small_robot()
        camera = description.sensors["camera"].model_copy(update={"width": 640, "height": 480})
        description = description.model_copy(
            update={"sensors": {**description.sensors, "camera": camera}}
        )
        return ScriptedRobot(description, readings={"camera": Painter(solids, **errors)})

    return build


@pytest.fixture
def tabletop() -> type[Tabletop]:
    """`tabletop(can=…, pose=…)`: Fetch before a can on a table; see `Tabletop`."""
    return Tabletop


@pytest.fixture
def scene_of() -> SceneOf:
    """`scene_of(robot)`: a planning scene that has been started and updated once."""

    def build(robot: ScriptedRobot) -> PlanningSceneService:
        service = PlanningSceneService()
        frames = FrameBuffer(robot.description.kinematics())
        site, random = scripted_site(), np.random.default_rng(0)
        service.start(
            ServiceContext(site, robot.description, frames, robot, random, {}, lambda name: None)
        )
        service.update(robot, robot.time)
        return service

    return build


@pytest.fixture
def stretched_out() -> ScriptedRobot:
    """A robot whose arm is stretched out with the camera that it carries, and does not move."""
    description = eye_in_hand_robot()
    joints = zip(description.groups["arm"].joints, (0.0, 2.0, 3.14, 0.0, 0.0, 0.0), strict=True)
    robot = ScriptedRobot(description, joints=dict(joints), readings={"camera": Painter([])})
    robot.frozen.add("arm")
    return robot
