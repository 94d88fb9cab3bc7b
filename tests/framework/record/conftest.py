"""Runs with a record: a tree written in the test, in a scripted world or in none."""

import numpy as np
import pytest

from momantu_bt.messages import CameraImage, LaserScan
from momantu_bt.record.reader import read_record
from momantu_bt.running.api import run
from momantu_bt.testing import ScriptedRobot, ScriptedWorld
from momantu_bt.tree.registry import Registry


def picture(robot):
    color = np.full((480, 640, 3), (250, 20, 10), dtype=np.uint8)
    color[0, 0] = round(robot.time * 20) % 256  # no two are the same
    depth = np.ones((480, 640), dtype=np.float32)
    return CameraImage(robot.time, "camera_frame", color, depth, np.eye(3))


def scan(robot):
    ranges = np.linspace(0.5, 3.0, 11)
    ranges[0], ranges[3] = 0.5 + robot.time / 10, np.inf
    return LaserScan(robot.time, "laser_frame", -1.0, 0.2, 0.1, 10.0, ranges)


@pytest.fixture
def seeing_robot():
    """A robot whose camera and laser answer."""
    robot = ScriptedRobot()
    sensors = robot.description.sensors
    makes = {"camera": picture, "laser": scan}
    robot.readings = {n: makes[s.kind] for n, s in sensors.items() if s.kind in makes}
    return robot


@pytest.fixture
def record_run(tmp_path):
    """Run a tree with a record; its report and what was read back."""

    def start(text, *skills, world=None, folder="record", **options):
        file = tmp_path / "tree.yaml"
        file.write_text(f"momantu_bt: 1\nmain: Main\n{text}", encoding="utf-8")
        registry = Registry(
            skills={skill.__name__.lower(): skill for skill in skills},
            services=options.pop("services", {}),
        )
        place = world if world is not None else ScriptedWorld()
        record = tmp_path / folder
        report = run(file, world=place, registry=registry, record=record, **options)
        return report, read_record(record)

    return start
