"""Fetch's model, and solids for it to avoid."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.arm_model import ArmModel, arm_model
from momantu_skills.manipulation.model.collision import BodyPairs, Obstacle, body_pairs
from momantu_skills.manipulation.motion.timing import timed
from momantu_worlds.robots import fetch

from momantu_bt.messages import JointTrajectory
from tests.skills.scenery.table import Tabletop


@pytest.fixture(scope="session")
def model() -> ArmModel:
    """Fetch's arm model."""
    return arm_model(fetch())


@pytest.fixture
def swing(tabletop: type[Tabletop], model: ArmModel) -> tuple[Tabletop, JointTrajectory]:
    """Fetch, and a trajectory of a second or two that turns its shoulder."""
    robot = tabletop(pose="carry")
    q = model.joints(robot.state())
    end = q.copy()
    end[1] += 0.8
    return robot, timed(model.group, np.array([q, end]), PlanningConfig())


@pytest.fixture(scope="session")
def body(model: ArmModel) -> BodyPairs:
    """Its collision shapes."""
    return body_pairs(model)


@pytest.fixture(scope="session")
def table() -> Obstacle:
    """A table 0.72 m high, 0.55 m before the base."""
    corners = np.array(list(product((0.55, 1.3), (-0.7, 0.7), (0.0, 0.72))))
    return Obstacle("table", corners, support=True)
