"""The surface in one view, and the camera's pose corrected by it: a surface is level."""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.geometry import Array, Transform
from momantu_skills.perception.geometry.regions import convex_hull
from momantu_skills.perception.surface.planes import PlaneConfig, find_plane, levelling


@dataclass(frozen=True, slots=True, eq=False)
class Standing:
    """odom_from_camera: corrected. height: of the surface, m in odom.

    outline: (k, 2) convex hull of its visible part, odom. area: of that part, m2.
    """

    odom_from_camera: Transform
    height: float
    outline: Array
    area: float


def standing(
    points: Array,
    odom_from_camera: Transform,
    low: float,
    high: float,
    config: PlaneConfig | None = None,
) -> Standing | None:
    """The level surface between two heights (m, odom) among points (n, 3); None without one."""
    plane = find_plane(points, low, high, config or PlaneConfig())
    if plane is None:
        return None
    turn, middle = levelling(plane), Transform((*plane.centre, plane.height))
    seen = points[plane.inliers]
    if turn is not None:
        camera = odom_from_camera.position
        about = Transform(camera) @ turn @ Transform(-camera)
        odom_from_camera, middle = about @ odom_from_camera, about @ middle
        seen = about.apply(seen)
    height = float(middle.position[2])
    return Standing(odom_from_camera, height, convex_hull(seen[:, :2]), plane.area)
