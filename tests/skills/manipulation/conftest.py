"""Fetch's model, and solids for it to avoid."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from momantu_skills.manipulation.model.arm_model import ArmModel, arm_model
from momantu_skills.manipulation.model.collision import BodyPairs, Obstacle, body_pairs
from momantu_worlds.robots import fetch


@pytest.fixture(scope="session")
def model() -> ArmModel:
    """Fetch's arm model."""
    return arm_model(fetch())


@pytest.fixture(scope="session")
def body(model: ArmModel) -> BodyPairs:
    """Its collision shapes."""
    return body_pairs(model)


@pytest.fixture(scope="session")
def table() -> Obstacle:
    """A table 0.72 m high, 0.55 m before the base."""
    corners = np.array(list(product((0.55, 1.3), (-0.7, 0.7), (0.0, 0.72))))
    return Obstacle("table", corners, support=True)
