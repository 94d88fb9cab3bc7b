"""The errors of robot files."""

from __future__ import annotations

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.formats.places import KeyPath
from momantu_bt.world import WorldError


class RobotFileError(DescriptionError):
    """A robot file, or a file that it names, is wrong; every problem with line and caret."""

    what = "robot"


class RobotNotInstalled(WorldError):
    """The robot file is right, but names a Python package that is not installed."""


class PartError(Exception):
    """One thing is wrong with what the robot file says at `place`."""

    def __init__(self, place: KeyPath, message: str) -> None:
        super().__init__(message)
        self.place, self.message = place, message
