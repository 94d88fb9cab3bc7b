"""What can be wrong with a robot file."""

from __future__ import annotations

from momantu_bt.descriptions.reading import DescriptionError, Place


class RobotFileError(DescriptionError):
    """A robot file, or a file that it names, is wrong; every problem with line and caret."""

    what = "robot"


class PartError(Exception):
    """One thing is wrong with what the robot file says at `place`."""

    def __init__(self, place: Place, message: str) -> None:
        super().__init__(message)
        self.place, self.message = place, message
