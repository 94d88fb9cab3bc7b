"""Robots by name: installed ones, and files in place of a name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from momantu_bt.errors import PLUGIN_ERRORS, MomantuError, words_of
from momantu_bt.importing import output_aside
from momantu_bt.plugins import Files, Group, PluginError
from momantu_bt.robot import RobotDescription
from momantu_bt.robots.reader import read_robot

GEOMETRY = (".urdf", ".xacro")
"""Suffixes of files that a robot file names and that a user may mistake for a robot file."""

Describe: TypeAlias = Callable[[], RobotDescription]


def load_robot(name: str) -> RobotDescription:
    """The robot of a name, or of a path.

    Raises:
        PluginError: no robot has this name (with the nearest ones), or its function raises.
        RobotFileError: its file is wrong.
    """
    describe = ROBOTS.load(name)
    try:
        with output_aside():
            return describe()
    except MomantuError:
        raise
    except PLUGIN_ERRORS as error:  # a plug-in's code, which may raise anything
        message = f"the robot {name!r} cannot be read: {words_of(error)}"
        raise PluginError(message) from error


def _objection(name: str, plugin: Any) -> str | None:
    return None if callable(plugin) else f"{plugin!r} is not a function that gives a description"


def _read(path: Path) -> Describe:
    if path.suffix in GEOMETRY:
        setup = f"momantu-bt robots setup {path}"
        raise PluginError(f"{path} is not a robot file, but a URDF; `{setup}` makes one of it")
    return lambda: read_robot(path)


ROBOTS: Group[Describe] = Group(
    "momantu_bt.robots", "robot", _objection, Files("robot.yaml", _read)
)
"""Functions that give a robot's description."""
