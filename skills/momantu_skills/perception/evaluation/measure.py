"""Let a detector look at labelled pictures."""

from __future__ import annotations

import numpy as np

from momantu_bt.categories import Symmetry
from momantu_bt.detector import ObjectDetector, View
from momantu_bt.geometry import Transform
from momantu_bt.labelled import Labelled
from momantu_bt.messages import ObjectClass, RobotState
from momantu_bt.service import Snapshot
from momantu_skills.perception.camera.cloud import points_from_depth
from momantu_skills.perception.camera.pictures import STRIDE
from momantu_skills.perception.evaluation.boxes import Solid
from momantu_skills.perception.evaluation.precision import Picture
from momantu_skills.perception.geometry.regions import depth_inside

SPAN = 0.03
"""How far from its true height a surface is looked for, m: the site's own tolerance."""
AROUND = 0.1
"""How far beyond a surface's true outline it may be seen, m."""
BELOW, ABOVE = 0.1, 0.6
"""Heights below and above a surface within which points are looked at, m."""
HANDLE = 40
"""Pixels of a handle from which on it tells how a mug is turned."""
OUTSIDE = 1.08
"""A mug's pixel belongs to its handle beyond this share of the radius."""


def measured(made: Labelled, detector: ObjectDetector) -> Picture:
    """What a picture shows, and what a detector finds in it."""
    view = view_of(made)
    low, high = made.height - SPAN, made.height + SPAN
    answer = detector.detect([view], low, high, ObjectClass(next(iter(made.categories)))) or ()
    camera_from_odom = made.odom_from_camera.inverse()
    found = tuple(
        (Solid(thing.category, camera_from_odom @ thing.pose.transform, thing.size), thing.score)
        for thing in answer
    )
    return Picture(_true(made), found)


def view_of(made: Labelled) -> View:
    """A picture as a detector gets it, with the points near its surface."""
    optical = points_from_depth(made.image.depth, made.image.intrinsics, STRIDE)
    points = made.odom_from_camera.apply(optical)
    points = points[np.abs(points[:, 2] - made.height - (ABOVE - BELOW) / 2) < (ABOVE + BELOW) / 2]
    points = points[depth_inside(points[:, :2], made.outline) > -AROUND]
    nothing = np.zeros(0)
    state = RobotState(
        made.image.stamp, (), nothing, nothing, nothing, Transform(), 0.0, 0.0, 0.0, 0.0
    )
    snapshot = Snapshot(made.image, made.odom_from_camera, Transform(), state)
    return View(snapshot, points)


def _true(made: Labelled) -> tuple[Solid, ...]:
    depth, k = made.image.depth, made.image.intrinsics
    found = []
    for thing in made.things:
        symmetry = made.categories[thing.category]
        turns = symmetry in (Symmetry.ROUND, Symmetry.ENDS)
        if symmetry is Symmetry.HANDLE:
            v, u = np.nonzero((made.numbers == thing.number) & (depth > 0))
            z = depth[v, u].astype(np.float64)
            x, y = (u - k[0, 2]) / k[0, 0] * z, (v - k[1, 2]) / k[1, 1] * z
            own = thing.camera_from_object.inverse().apply(np.column_stack([x, y, z]))
            out = np.hypot(own[:, 0], own[:, 1]) > OUTSIDE * thing.size[0] / 2
            turns = int(out.sum()) < HANDLE
        found.append(Solid(thing.category, thing.camera_from_object, thing.size, turns, symmetry))
    return tuple(found)
