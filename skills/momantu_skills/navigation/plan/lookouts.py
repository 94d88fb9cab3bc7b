"""Stands from which a place on the floor can be looked at, from all sides."""

from __future__ import annotations

import math
from collections.abc import Sequence

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.world import Surface
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.plan.clear_view import beside, is_hidden
from momantu_skills.navigation.plan.goals import Stand

BEARINGS = 12
"""Number of directions from which the place is looked at."""
FARTHER = (0.0, 0.3, 0.6, 0.9)
"""Distances beyond the nearest one, m, tried in turn if an obstacle occupies the nearest stand."""
SEEN_FROM = 2.0
"""Cost of a stand in a direction from which somebody looked before, m."""
APART = math.radians(70.0)
"""Angle between two directions that show different sides."""


def lookouts(
    middle: tuple[float, float],
    distance: float,
    base: Pose2D,
    before: Sequence[Pose2D],
    costmap: Costmap,
    surface: Surface,
) -> list[Stand]:
    """Stands that face a point (x, y), at least `distance` m from it, best first; all in the map.

    Walls and furniture on the map hide the point; what is drawn of `surface` does not, as it may
    stand elsewhere. base: a shorter drive is better. before: from where somebody looked already.
    """
    hiding = beside(surface, costmap.known, costmap.grid)
    x, y = middle
    used = [math.atan2(pose.y - y, pose.x - x) for pose in before]
    stands: list[Stand] = []
    for number in range(BEARINGS):
        bearing = wrap_angle(2 * math.pi * number / BEARINGS)
        again = any(abs(wrap_angle(bearing - one)) < APART for one in used)
        for farther in FARTHER:
            off = distance + farther
            pose = Pose2D(
                x + off * math.cos(bearing),
                y + off * math.sin(bearing),
                wrap_angle(bearing + math.pi),
            )
            if not is_hidden(costmap.grid, hiding, pose, middle):
                cost = pose.distance_to(base) + farther + (SEEN_FROM if again else 0.0)
                stands.append(Stand(pose, number, cost))
    return sorted(stands, key=lambda stand: stand.cost)
