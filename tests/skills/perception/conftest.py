"""Views of painted solids, as perception's own parts take them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from momantu_skills.perception.camera.pictures import see
from momantu_skills.perception.geometry.regions import Region, disc

from momantu_bt.detector import View
from momantu_bt.geometry import Transform
from momantu_bt.service import Snapshot
from momantu_bt.testing.painting import Solid
from tests.skills.scenery.onlooker import Onlooker, SeenScene, Viewed


@pytest.fixture
def viewed(onlooker: Onlooker, seen_scene: type[SeenScene]) -> Viewed:
    """`viewed(solids, pans=(0.0,), …)`: views of the space around (1, 0) from the origin.

    The camera's errors are those of `Painter`; its mounting error is not in the views' poses.
    """

    def take(solids: Sequence[Solid], pans: Sequence[float] = (0.0,), **errors: Any) -> list[View]:
        robot = onlooker(solids, **errors)
        region = Region(disc(disc_centre, 0.7), 0.6, 1.3)
        views = []
        for pan in pans:
            robot.joints.update(pan=pan, tilt=0.5, lift=0.2)
            robot.time += 0.1
            image = robot.read("camera")
            kinematics = robot.description.kinematics()
            camera = kinematics.base_from_frame(image.frame, robot.joints)
            snapshot = Snapshot(image, camera, Transform(), robot.state())
            views.append(see(snapshot, region, seen_scene()))
        return views

    disc_centre = (1.0, 0.0)
    return take
