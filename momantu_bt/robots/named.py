"""Robots as a command line names them: the name of an installed one, or a file."""

from __future__ import annotations

from momantu_bt.plugins import ROBOTS, load
from momantu_bt.robot import RobotDescription


def load_robot(name: str) -> RobotDescription:
    """The robot of a name, or of a path.

    Raises:
        PluginError: there is no such robot; the message names the nearest ones.
        WorldError: its file is wrong.
    """
    description: RobotDescription = load(ROBOTS, name)()
    return description
