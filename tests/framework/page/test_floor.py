"""The map: where everything is drawn."""

import base64
import io
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from momantu_bt.geometry import Transform, quaternion_from_rpy
from momantu_bt.page.floor import floor

ANGLES = st.floats(-3.1, 3.1)


@pytest.fixture(scope="module")
def shown(recording):
    return floor(recording())


def test_the_plan_is_a_picture_with_its_first_row_at_the_bottom(shown):
    image = shown["image"]
    assert (image["x"], image["y"], image["width"], image["height"]) == (-4.0, -3.0, 8.0, 6.0)
    data = base64.b64decode(image["data"].partition(",")[2])
    pixels = np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))
    assert pixels.shape == (60, 80, 4)
    # cell (row 10, column 10) is a wall, the one above it and to its right is free, (0, 0) unknown
    assert pixels[59 - 10, 10, 3] == 255
    assert pixels[59 - 11, 11, 3] == 0
    assert 0 < pixels[59, 0, 3] < 255
    assert image["used"] == pytest.approx([-3.0, -2.0, 3.0, 2.0])


def test_all_that_is_drawn_is_within_bounds(shown):
    left, bottom, right, top = shown["bounds"]
    points = [(p["x"], p["y"]) for p in (*shown["places"], *shown["surfaces"])]
    points += zip(shown["path"]["x"], shown["path"]["y"], strict=True)
    assert all(left < x < right and bottom < y < top for x, y in points)


def test_the_path_is_in_the_map_and_leaves_out_what_was_before(shown):
    path = shown["path"]
    assert len(path["t"]) == 25
    assert (path["x"][0], path["y"][0]) == (-2.0, 0.0)
    assert 9.0 not in path["x"]


def test_objects_come_go_and_are_held(shown):
    assert shown["scenes"]["t"] == [1.0, 4.0]
    lying, held = shown["scenes"]["items"]
    # odom lies 1 m along x in the map
    assert lying == [{"name": "can", "x": 1.5, "y": 1.0, "size": 0.07}]
    assert held == [{"name": "can"}]


@given(roll=st.floats(-0.5, 0.5), pitch=st.floats(-0.5, 0.5), yaw=ANGLES)
def test_headings_are_those_of_the_transform(recording, roll, pitch, yaw):
    transform = Transform((1.0, 2.0, 0.5), quaternion_from_rpy(roll, pitch, yaw))
    w, x, y, z = transform.quaternion.tolist()
    pose = {
        "position": dict(zip("xyz", transform.position.tolist(), strict=True)),
        "orientation": {"x": x, "y": y, "z": z, "w": w},
    }
    message = json.dumps({"frame_id": "map", "pose": pose}).encode()
    path = floor(recording(raw={"/pose": ((0.0, message),)}))["path"]
    assert abs(math.remainder(path["yaw"][0] - transform.yaw, math.tau)) < 1e-3


def test_without_a_map_the_path_is_in_odom_and_bounds_are_around_it(recording):
    origin = {"x": 0.0, "y": 0.0, "z": 0.0}
    pose = {"position": origin, "orientation": {**origin, "w": 1.0}}
    message = json.dumps({"frame_id": "odom", "pose": pose}).encode()
    found = floor(recording(raw={"/pose": ((0.0, message),)}, files={}))
    assert found["image"] is None
    assert found["places"] == []
    assert found["bounds"] == [-2.0, -2.0, 2.0, 2.0]
