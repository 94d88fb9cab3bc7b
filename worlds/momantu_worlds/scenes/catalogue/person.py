"""A person: the catalogue's figure as a body that moves by itself."""

from __future__ import annotations

from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.catalogue.furniture import furniture, usual_size
from momantu_worlds.scenes.geometry.bodies import Body, Color

CATEGORY = "figure"
DEPTH = usual_size(CATEGORY)[0]
"""From chest to back, m."""
CLOTHES: Color = (0.35, 0.42, 0.62)


def person_body(name: str, pose: Pose2D, color: Color = CLOTHES) -> Body:
    """Somebody who stands at a pose of the map and looks along its x; the world moves the body."""
    parts = furniture(CATEGORY, usual_size(CATEGORY), color)
    return Body(name, CATEGORY, pose.transform(), parts, kinematic=True)
