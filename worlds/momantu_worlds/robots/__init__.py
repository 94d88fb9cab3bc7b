"""The robots that this package brings; cheap to import, no simulator is loaded."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.robot import RobotDescription
from momantu_bt.robots import read_robot

FOLDER = Path(__file__).parent


def fetch() -> RobotDescription:
    """Fetch Robotics' Fetch, with the geometry that the mani_skill package carries.

    Raises:
        WorldError: the mani_skill package, or its Fetch, is not installed.
    """
    return read_robot(FOLDER / "fetch")


def kinova_jackal() -> RobotDescription:
    """Clearpath's Jackal with a Kinova j2n6s300, built of primitives."""
    return read_robot(FOLDER / "kinova_jackal")
