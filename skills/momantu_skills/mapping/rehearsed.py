"""The mapping service with a map already begun, for test runs of skills that save it."""

from __future__ import annotations

import math
import shutil
import tempfile
import weakref
from pathlib import Path

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_bt.service import ServiceContext
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.service import MappingService
from momantu_skills.navigation.map.sensing import Rays

BEAMS = 180
HALF = 3.0
"""Half the edge of the square room whose walls the scans show, m."""
STEP = 0.2
"""Way between the scans, m."""


class BegunMapping(MappingService):
    """Has two scans of a square room from the start. folder: one to write to, while it lives."""

    def __init__(self) -> None:
        """Make the folder; it goes with the service."""
        super().__init__()
        made = tempfile.mkdtemp(prefix="momantu_bt_")
        weakref.finalize(self, shutil.rmtree, made, ignore_errors=True)
        self.folder = Path(made) / "map"

    def start(self, context: ServiceContext) -> None:
        """Begin as usual, with the scans."""
        super().start(context)
        for number in range(2):
            at = Pose2D(number * STEP, 0.0, 0.0)
            self.survey.add(LoggedScan(0.01 * number, at, _room(at)))


def _room(at: Pose2D) -> Rays:
    """What a laser in the base's middle sees of the room's walls."""
    angles = np.arange(BEAMS) * (2.0 * math.pi / BEAMS) - math.pi + 0.01
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    place = np.array([at.x, at.y])
    ranges = ((HALF - np.sign(directions) * place) / np.abs(directions)).min(axis=1)
    return Rays(np.zeros(2), directions, ranges, np.ones(BEAMS, dtype=bool))
