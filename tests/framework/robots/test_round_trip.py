"""A robot file's model, written as YAML and read again, describes the same robot."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

from ruamel.yaml import YAML

from momantu_bt.robots import read_robot
from momantu_bt.robots.reader import read_robot_file

Write = Callable[..., Path]


def test_a_dumped_model_reads_the_same(carter: Write) -> None:
    file = carter()
    model, robot = read_robot_file(file), read_robot(file)
    text = io.StringIO()
    YAML().dump(model.as_written(), text)
    file.write_text(text.getvalue())
    assert read_robot_file(file) == model
    again = read_robot(file)
    assert again == robot
    assert again.urdf.read_bytes() == robot.urdf.read_bytes()
