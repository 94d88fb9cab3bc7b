"""Bodies of a world file, part by part."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Mass, Size
from momantu_worlds.scenes.file.furniture import MeshUse
from momantu_worlds.scenes.file.values import (
    Friction,
    Name,
    Part,
    PlanarPose,
    Pose3D,
    Rgb,
    Sides,
    Size3D,
    with_one_diameter,
)
from momantu_worlds.scenes.geometry.bodies import GREY

MOST_PARTS = 500
ORIGIN = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class CylinderNote(Part):
    """A cylinder around its own z, m."""

    radius: Size
    height: Size


class BodyPart(Part):
    """One shape of a body; `at` is its pose in the body. A mesh keeps its own colours."""

    box: Size3D | None = None
    cylinder: CylinderNote | None = None
    sphere: Size | None = None
    mesh: MeshUse | None = None
    at: Pose3D = ORIGIN
    color: Rgb = GREY
    visual: bool = True
    collision: bool = True

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        shapes = (self.box, self.cylinder, self.sphere, self.mesh)
        if sum(shape is not None for shape in shapes) != 1:
            raise ValueError("needs exactly one of box, cylinder, sphere (its radius), mesh")
        if not self.visual and not self.collision:
            raise ValueError("is neither seen nor touched; leave it out")
        return self


class BodySurface(Part):
    """The top of a body, as a surface of the site; in the map.

    height: above the floor, m. round: it is a disc, and `size` has its diameter twice.
    """

    at: PlanarPose
    size: tuple[Size, Size]
    height: Size
    sides: Sides
    round: bool = False

    @model_validator(mode="after")
    def _one_diameter(self) -> Self:
        if self.round:
            with_one_diameter(self.size)
        return self


class BodyNote(Part):
    """A rigid body. mass: kg, if it is not static. surface: objects may stand on its top."""

    category: Name = "body"
    static: bool = True
    mass: Mass | None = None
    friction: Friction = 0.6
    at: Pose3D = ORIGIN
    parts: Annotated[tuple[BodyPart, ...], Field(min_length=1, max_length=MOST_PARTS)]
    surface: BodySurface | None = None

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.static and self.mass is not None:
            raise ValueError("a static body has no mass; leave it out, or write static: false")
        if not self.static and self.mass is None:
            raise ValueError("a body that is not static needs a mass")
        if not self.static and self.surface is not None:
            raise ValueError("only the top of a static body is a surface of the site")
        if not self.static and not any(_touches(part) for part in self.parts):
            raise ValueError("a body that is not static needs a part that touches the floor")
        return self


def _touches(part: BodyPart) -> bool:
    return part.collision and (part.mesh is None or part.mesh.collision != "none")
