"""name_place: teach the robot a name, for where it stands or for a surface that it has measured."""

from __future__ import annotations

import math
import re
from typing import ClassVar

import numpy as np

from momantu_bt.frames import MAP
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.lazy import lazily
from momantu_bt.messages import SupportPlane
from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.site_file import NAME
from momantu_bt.skill import Failure, In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_bt.world import Places, Surface, Surfaces
from momantu_skills.navigation.localize.confidence import is_localized

with lazily():
    from momantu_skills.perception.geometry import rectangles

LEAST_EDGE = 0.1
"""Shorter edges belong to no surface that something is put on, m."""


class NamePlace(Skill):
    """Give a name to the place where the base stands, or to a surface from `detect_plane`.

    From then on it is a name like those of the site, for the rest of the run; `save_map` writes it
    into site.yaml. On a map that is still being made it moves with the scans about it when a loop
    is closed. A name that is known already is given anew. A surface is taken as a rectangle,
    approached from all four sides, the one before the robot first; what was not seen of it is not
    part of it.
    """

    name: str = In(names="taught", doc="lower-case letters, digits and underscores")
    plane: SupportPlane | None = In(None, doc="the surface; by default where the base stands")

    also_called: ClassVar = ("teach_place", "remember_place", "name_surface", "save_place")
    failures: ClassVar = {
        "BAD_NAME": "the name is not like `table_a`, or names a thing of the other kind",
        "BAD_SURFACE": "what was measured is too small for a surface",
        "NOT_LOCALIZED": "the robot is not sure enough where it is",
    }
    activities: ClassVar = {}
    symptoms: ClassVar = {"NOT_LOCALIZED": {Symptom.NOT_LOCALIZED}}

    localization: Localization = Needs()

    def run(self, robot: Robot) -> Run:
        """Teach it."""
        places, surfaces = self.site.places, self.site.surfaces
        self._check()
        yield "naming"
        if not is_localized(self.localization):
            raise Failure("NOT_LOCALIZED", "the robot is not sure where it is: relocalize first")
        if self.plane is None:
            here = self.localization.map_from_base
            assert isinstance(places, Places)
            places.teach(self.name, here)
            self.log(
                f"{self.name} is ({here.x:.2f}, {here.y:.2f}), {math.degrees(here.yaw):.0f} deg"
            )
            return
        surface = self._surface(self.plane)
        assert isinstance(surfaces, Surfaces)
        surfaces.teach(self.name, surface)
        at, (width, depth) = surface.map_from_surface, surface.size
        self.log(
            f"{self.name} is {width:.2f} x {depth:.2f} m, {surface.height:.2f} m high, at "
            f"({at.x:.2f}, {at.y:.2f})"
        )

    def _check(self) -> None:
        places, surfaces = self.site.places, self.site.surfaces
        if not re.fullmatch(NAME, self.name) or len(self.name) > 60:
            raise Failure(
                "BAD_NAME",
                f"{self.name!r} is no name; expected a lower-case letter, then letters, digits and "
                "underscores, at most 60, such as `table_a`",
            )
        other = surfaces if self.plane is None else places
        if self.name in other:
            kind = "surface" if self.plane is None else "place"
            raise Failure("BAD_NAME", f"{self.name!r} is a {kind} already; choose another name")

    def _surface(self, plane: SupportPlane) -> Surface:
        map_from_plane = self.frames.lookup(MAP, plane.pose.frame) @ plane.pose.transform
        flat = np.array(plane.outline)
        corners = map_from_plane.apply(np.column_stack([flat, np.zeros(len(flat))]))
        found = rectangles.smallest_rectangle(corners[:, :2])
        width, depth = (float(edge) for edge in found.size)
        if min(width, depth) < LEAST_EDGE:
            raise Failure("BAD_SURFACE", f"it measures {width:.2f} x {depth:.2f} m only")
        at = Pose2D(float(found.centre[0]), float(found.centre[1]), found.yaw)
        base = at.inverse() @ self.localization.map_from_base
        towards = math.atan2(base.y / depth, base.x / width)
        first = round(towards / (math.pi / 2)) * (math.pi / 2)
        sides = tuple(wrap_angle(first + k * math.pi / 2) for k in (0, 1, -1, 2))
        return Surface(at, (width, depth), float(map_from_plane.position[2]), sides)
