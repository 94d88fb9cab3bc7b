"""A category of one's own, from meshes.

Every fourth mesh in the order of their names is kept for testing, of two or three the last one. A
mesh stands as in its file, or lies on any side of its convex hull on which it does not tip over.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from momantu_bt.categories import USUAL, Symmetry
from momantu_bt.errors import InputError
from momantu_bt.geometry import Array, Transform
from momantu_bt.world import seeded
from momantu_worlds.labelled.own_files import named_meshes
from momantu_worlds.labelled.shape import Draw, Shape, draw_color
from momantu_worlds.scenes.arrange.mesh_files import mesh_parts
from momantu_worlds.scenes.file.furniture import MeshUse
from momantu_worlds.scenes.geometry.bodies import Hull, Mesh, Part

HELD_BACK = 4
"""One of so many meshes is kept for testing."""
SMALLEST, LARGEST = 0.01, 0.45
"""Range of the longest extent of a thing on a table, m."""
VARIED = 0.12
"""Largest share by which a mesh is drawn larger or smaller than it is."""
OTHER_COLOR = 0.5
"""Share of the things that have another colour than their mesh."""
TURNS = (0.7, 1.7, 3.0)
"""Angles by which a round thing may be turned without a difference, rad."""
SAMPLES, ALIKE = 4000, 98.0
"""Points on a mesh that are compared with the turned mesh, and the percentile that must agree."""
SPACING = 1.8
"""Distance up to which they agree, in units of the points' mean spacing."""
FLAT = 0.01
"""Points of a hull's side lie this near to its plane, as a share of the mesh's diagonal."""
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A mesh. shape: in its own frame, standing. lying: turns (3, 3) in which it rests."""

    shape: Shape
    lying: tuple[Array, ...]
    round: bool


@dataclass(frozen=True, slots=True, eq=False)
class OwnCategory:
    """A category. training, testing: its meshes."""

    name: str
    symmetry: Symmetry
    training: tuple[Model, ...]
    testing: tuple[Model, ...]

    def shape(self, draw: Draw, *, testing: bool) -> Shape:
        """A shape of a random mesh, a little larger or smaller, often in another colour."""
        models = self.testing if testing else self.training
        model = models[int(draw.integers(len(models)))]
        scale = draw.uniform(1.0 - VARIED, 1.0 + VARIED)
        color = draw_color(draw) if draw.random() < OTHER_COLOR else None
        parts = tuple(_scaled(part, scale) for part in model.shape.parts)
        if color is not None:
            parts = tuple(replace(part, color=color, geometry=_bare(part)) for part in parts)
        x, y, z = (scale * edge for edge in model.shape.size)
        return replace(
            model.shape,
            category=self.name,
            size=(x, y, z),
            parts=parts,
            outline=scale * model.shape.outline,
            lying=model.lying,
        )


def own_category(
    name: str, meshes: Path, scale: float = 1.0, up: Literal["z", "y"] = "z", *, testing: bool
) -> OwnCategory:
    """The category of some meshes. scale: metres of a unit of the files. up: their axis.

    meshes: a folder or a pattern; see `named_meshes`.

    Raises:
        InputError: the name cannot be one, there are too few meshes, or one is too large.
        WorldError: a mesh cannot be read.
    """
    if not _NAME.fullmatch(name) or name in (*USUAL, "nothing", "handle"):
        raise InputError(
            f"--category {name!r}; expected a word of small letters, digits and _ that is none of "
            f"{', '.join(USUAL)}, nothing, handle"
        )
    files = named_meshes(meshes)
    held = [number % HELD_BACK == HELD_BACK - 1 for number in range(len(files))]
    held[-1] |= len(files) > 1 and not any(held)
    if testing and not any(held):
        raise InputError(
            f"--meshes {meshes} holds one mesh, so none is kept for testing; add a second one"
        )
    models = [_model(family, file, scale, up) for family, file in files]
    symmetry = Symmetry.ROUND if all(model.round for model in models) else Symmetry.NONE
    kept = tuple(model for model, is_held in zip(models, held, strict=True) if not is_held)
    tested = tuple(model for model, is_held in zip(models, held, strict=True) if is_held)
    return OwnCategory(name, symmetry, kept, tested)


def _model(family: str, file: Path, scale: float, up: Literal["z", "y"]) -> Model:
    parts = mesh_parts(MeshUse(file=str(file), scale=scale, up=up), file, standing=True, color=None)
    vertices = np.concatenate(
        [part.geometry.vertices for part in parts if isinstance(part.geometry, Mesh)]
    )
    extent = np.ptp(vertices, axis=0)
    if not SMALLEST <= float(extent.max()) <= LARGEST:
        raise InputError(
            f"{file} is {' x '.join(f'{edge:.3g}' for edge in extent)} m; the longest edge of a "
            f"thing on a table is {SMALLEST} to {LARGEST} m: give the metres of a unit of the file "
            "by --scale, such as 0.001 for millimetres"
        )
    down = Transform((0.0, 0.0, -float(extent[2]) / 2))
    shown = tuple(
        replace(part, body_from_part=down @ part.body_from_part) for part in parts if part.visual
    )
    corners = next(part.geometry.vertices for part in parts if isinstance(part.geometry, Hull))
    corners = corners - (0.0, 0.0, float(extent[2]) / 2)
    is_round = _is_round([part for part in parts if part.visual])
    x, y, z = extent.tolist()
    if is_round:
        x = y = max(x, y)
    shape = Shape("", family, (x, y, z), shown, corners, None)
    return Model(shape, _lying(corners), is_round)


def _is_round(parts: Sequence[Part]) -> bool:
    """Whether a mesh that stands on the origin looks the same however it is turned about z."""
    corners = np.concatenate(
        [
            part.geometry.vertices[part.geometry.triangles]
            for part in parts
            if isinstance(part.geometry, Mesh)
        ]
    )
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    draw = seeded("round", len(corners))
    picked = corners[draw.choice(len(corners), SAMPLES, p=areas / areas.sum())]
    share = draw.dirichlet((1.0, 1.0, 1.0), SAMPLES)
    points = np.einsum("nk,nkx->nx", share, picked)
    near = SPACING * float(np.sqrt(areas.sum() / 2 / SAMPLES))
    tree = cKDTree(points)
    for turn in TURNS:
        turned = Transform.from_rpy((0.0, 0.0, 0.0), (0.0, 0.0, turn)).apply(points)
        if float(np.percentile(tree.query(turned)[0], ALIKE)) > near:
            return False
    return True


def _lying(corners: Array) -> tuple[Array, ...]:
    """Turns (3, 3) that lay a convex thing with corners (n, 3) on each side that carries it."""
    hull = ConvexHull(corners)
    middle = corners.mean(axis=0)
    near = FLAT * float(np.linalg.norm(np.ptp(corners, axis=0)))
    found: list[Array] = []
    normals: list[Array] = []
    for *normal, offset in hull.equations:
        outwards = np.array(normal)
        if outwards[2] < -0.9 or any(float(outwards @ other) > 0.999 for other in normals):
            continue  # it stands on it, or it is the same side
        turn = _downwards(outwards)
        flat = (corners[np.abs(corners @ outwards + offset) < near] @ turn.T)[:, :2]
        if len(flat) >= 3 and _inside((turn @ middle)[:2], flat):
            found.append(turn)
            normals.append(outwards)
    return tuple(found)


def _downwards(direction: Array) -> Array:
    """A rotation (3, 3) that turns a unit vector to -z."""
    aside = np.eye(3)[int(np.abs(direction).argmin())]
    x = np.cross(direction, aside)
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(-direction, x), -direction])


def _inside(point: Array, flat: Array) -> bool:
    """Whether a point (2,) lies within the convex hull of points (n, 2)."""
    if np.linalg.matrix_rank(flat - flat.mean(axis=0), tol=1e-4) < 2:
        return False
    equations = ConvexHull(flat).equations
    return bool((equations[:, :2] @ point + equations[:, 2] <= 0.0).all())


def _scaled(part: Part, scale: float) -> Part:
    assert isinstance(part.geometry, Mesh)
    at = Transform(scale * part.body_from_part.position, part.body_from_part.quaternion)
    geometry = replace(part.geometry, vertices=scale * part.geometry.vertices)
    return replace(part, geometry=geometry, body_from_part=at)


def _bare(part: Part) -> Mesh:
    """A mesh without its texture."""
    assert isinstance(part.geometry, Mesh)
    return replace(part.geometry, uv=None, texture=None)
