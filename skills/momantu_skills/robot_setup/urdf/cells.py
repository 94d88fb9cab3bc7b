"""Cutting long meshes whose hulls would swallow other links.

A simulator takes every mesh for its convex hull. The hull around a torso with shoulders and neck
swallows the arm folded before it, and pushes it out; cut into cells it does not.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from momantu_skills.manipulation.model.hulls import part_points, placed
from momantu_skills.manipulation.model.shapes import LONGEST_HULL
from momantu_skills.manipulation.model.urdf import CollisionPart
from momantu_skills.robot_setup.urdf.body import Body, hulls_meet

CELL = 0.15
"""m; a cell is about this large: narrower than what an arm is folded into."""


def swallowed(
    body: Body,
    poses: Mapping[str, Mapping[str, float]],
    ignored: Iterable[tuple[str, str]],
) -> Iterator[tuple[str, str, str]]:
    """(pose, link, long link) where a link lies in the hull of a long link's mesh.

    ignored: pairs whose meeting says nothing.
    """
    apart = {frozenset(pair) for pair in ignored}
    long = [part for part in body.urdf.parts if is_long(part)]
    for pose, joints in poses.items():
        at = body.link_poses(joints, list(body.hulls))
        for part in long:
            solid = placed(part_points(part), at[part.link])
            for link in body.hulls:
                if (
                    frozenset((link, part.link)) not in apart
                    and not body.shapes.adjacent(link, part.link)
                    and hulls_meet(solid, placed(body.hulls[link], at[link]))
                ):
                    yield pose, link, part.link


def is_long(part: CollisionPart) -> bool:
    """Whether a part is a mesh that planning takes as it is, not for its hull."""
    return part.kind == "mesh" and float(np.ptp(part_points(part), axis=0).max()) >= LONGEST_HULL


def cuts_of(body: Body, link: str) -> dict[str, tuple[float, ...]]:
    """Even cuts across x, y and z of a link's meshes, in the meshes' own units and frame."""
    parts = [part for part in body.urdf.parts if part.link == link and part.kind == "mesh"]
    own = [part.link_from_part.inverse().apply(part_points(part)) for part in parts]
    points, scale = np.vstack(own), np.array(parts[0].size)
    low, high = points.min(axis=0), points.max(axis=0)
    cuts = {}
    for axis, name in enumerate("xyz"):
        count = round(float(high[axis] - low[axis]) / CELL)
        places = np.linspace(low[axis], high[axis], max(count, 1) + 1)[1:-1] / scale[axis]
        if len(places):
            cuts[name] = tuple(round(float(place), 3) for place in places)
    return cuts
