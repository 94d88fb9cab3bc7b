"""Values that skills exchange: plug-ins name their own types; anything becomes JSON data."""

import json
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

from momantu_bt import messages
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, plain, register_value_type
from momantu_bt.values.types import parse_type


@dataclass(frozen=True)
class Door:
    width: float


@pytest.fixture(autouse=True)
def own_types() -> Iterator[None]:
    before = dict(messages.VALUE_TYPES)
    yield
    messages.VALUE_TYPES.clear()
    messages.VALUE_TYPES.update(before)


def test_a_plug_ins_type_can_be_named_in_trees() -> None:
    register_value_type("door", Door)
    register_value_type("door", Door)
    assert parse_type("door") is Door
    assert parse_type("list of door") == tuple[Door, ...]


def test_a_taken_name_is_refused_with_what_it_is() -> None:
    with pytest.raises(ValueError, match="'pose' is already Pose"):
        register_value_type("pose", Door)


def test_values_become_json() -> None:
    pose = Pose(Transform((1.0, 2.0, 3.0)), "odom", 4.0)
    seen = DetectedObject("can", pose, (0.07, 0.07, 0.13), "cylinder", 0.9, 0.72)
    told = json.loads(json.dumps(plain({"seen": seen, "n": np.float32(0.5), "a": np.arange(2)})))
    assert told["seen"]["pose"]["transform"]["position"] == [1.0, 2.0, 3.0]
    assert told["seen"]["pose"]["frame"] == "odom"
    assert (told["n"], told["a"]) == (0.5, [0, 1])
