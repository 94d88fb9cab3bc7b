"""Checks of a site's zones: whether the robot may start where it does, and where they lie."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_worlds.checking.scenario import Scenario

EDGE = 10
"""Points of each side of the robot's outline that are looked at."""


def zones(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that the start is in no keep-out zone, and that every zone lies on the floor."""
    corners = scenario.robot.outline(scenario.episode.start)
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    outline = np.concatenate([np.linspace(a, b, EDGE) for a, b in sides])
    low, high = scenario.extent
    for name, zone in scenario.episode.site.zones.items():
        place = ("site", "zones", name)
        depth = -float(zone.distance(outline).min())
        if zone.kind == "keep_out" and depth > 0.0:
            yield FindingAtKeys(
                Severity.ERROR,
                "start-kept-out",
                f"the robot starts {100 * depth:.0f} cm inside the keep-out zone {name}",
                "give it a start outside, a smaller `start.shift`, or change the zone",
                place,
                about=(name,),
                amount=depth,
            )
        own = np.array(zone.corners)
        if (own.max(axis=0) < low).any() or (own.min(axis=0) > high).any():
            yield FindingAtKeys(
                Severity.WARNING,
                "zone-elsewhere",
                f"the zone {name} lies beside everything that stands here: x "
                f"{own[:, 0].min():g} to {own[:, 0].max():g} m, y {own[:, 1].min():g} to "
                f"{own[:, 1].max():g} m",
                "give its corners in the map's frame; bare numbers are metres",
                place,
                about=(name,),
            )
