"""Robots as files: reading `robot.yaml`, assembling its parts into one URDF.

Light: no simulator, no planner. See docs/robots.md for the format.
"""

from momantu_bt.robots.errors import RobotFileError, RobotNotInstalled
from momantu_bt.robots.reader import read_robot

__all__ = ["RobotFileError", "RobotNotInstalled", "read_robot"]
