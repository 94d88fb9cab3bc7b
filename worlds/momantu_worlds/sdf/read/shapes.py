"""Visuals and collisions: geometry, colours, friction."""

from __future__ import annotations

import math
from pathlib import Path

from momantu_worlds.sdf.read.document import Element
from momantu_worlds.sdf.read.model import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Material,
    MeshFile,
    Plane,
    Shape,
    Sphere,
)
from momantu_worlds.sdf.read.reading import Reading
from momantu_worlds.sdf.read.unread import list_leftovers
from momantu_worlds.sdf.read.values import (
    color_of,
    flag,
    length,
    lengths,
    name_of,
    number,
    pose_of,
    vector,
)

INVISIBLE = 0.95
"""Transparency above which a visual is left out as invisible."""
PLANE_SIZE = (1.0, 1.0)
"""Default size of a plane in SDF, m."""
_PBR_COLORS = ("pbr/metal/albedo_map", "pbr/specular/albedo_map")


def shapes_of(
    link: Element, tag: str, subject: str, reading: Reading
) -> tuple[tuple[Shape, ...], int]:
    """The visuals or the collisions of a link that can be carried over, and how many are lost.

    Those that are empty or invisible are not lost.
    """

    def read(element: Element) -> Shape | None:
        reading.count_shape(element.place)
        return _shape(element, f"{subject}/{name_of(element)}", reading)

    wanted = [element for element in link.all(tag) if _shows(element, subject, reading)]
    found = [shape for shape in reading.each(wanted, subject, read) if shape is not None]
    return tuple(found), len(wanted) - len(found)


def _shows(element: Element, subject: str, reading: Reading) -> bool:
    """Whether a visual or a collision is meant to be there: neither empty nor invisible."""
    if element.find("geometry/empty") is not None:
        return False
    name = element.attributes.get("name", "")
    hidden = reading.each([element], subject, lambda e: _invisible(e, f"{subject}/{name}", reading))
    return hidden == [False]


def _shape(element: Element, subject: str, reading: Reading) -> Shape | None:
    list_leftovers(
        element,
        subject,
        ("pose", "geometry", "material", "surface", "transparency"),
        reading.deviations,
    )
    around = element.child("geometry")
    if around is None:
        raise element.error(f"<{element.tag}> needs a <geometry>")
    geometry = _geometry(around, subject, reading)
    if geometry is None:
        return None
    return Shape(
        name_of(element),
        element.place,
        pose_of(element),
        geometry,
        _material(element, subject, reading),
        _friction(element, subject, reading),
    )


def _invisible(element: Element, subject: str, reading: Reading) -> bool:
    transparency = number(element, "transparency", 0.0)
    if transparency >= INVISIBLE:
        where = element.child("transparency") or element
        reading.deviations.dropped(where.place, subject, "an invisible visual", "left out")
        return True
    if transparency > 0.0:
        where = element.child("transparency") or element
        reading.deviations.changed(
            where.place, subject, f"{transparency:.0%} transparent", "drawn as if it were not"
        )
    return False


def _geometry(around: Element, subject: str, reading: Reading) -> Geometry | None:
    """The geometry; None, and a deviation, when it is of a kind that is not carried over.

    Raises:
        SdfError: its sizes are missing or impossible.
    """
    for element in around.children:
        tag = element.tag
        if tag == "box":
            x, y, z = lengths(element, "size", 3)
            return Box((x, y, z))
        if tag == "cylinder":
            return Cylinder(length(element, "radius"), length(element, "length"))
        if tag == "sphere":
            return Sphere(length(element, "radius"))
        if tag == "capsule":
            return Capsule(length(element, "radius"), length(element, "length"))
        if tag == "cone":
            return Cone(length(element, "radius"), length(element, "length"))
        if tag == "ellipsoid":
            x, y, z = lengths(element, "radii", 3)
            return Ellipsoid((x, y, z))
        if tag == "plane":
            return _plane(element)
        if tag == "mesh":
            return _mesh(element, subject, reading)
        if tag != "empty":
            reading.deviations.dropped(element.place, subject, f"a {tag}", "left out, not its body")
    return None


def _plane(element: Element) -> Plane:
    x, y, z = vector(element, "normal", (0.0, 0.0, 1.0))
    if math.hypot(x, y, z) < 1e-6:
        raise element.error("<plane> has a normal without length")
    size = lengths(element, "size", 2) if element.child("size") is not None else PLANE_SIZE
    return Plane((x, y, z), (size[0], size[1]))


def _mesh(element: Element, subject: str, reading: Reading) -> MeshFile | None:
    uri = element.child("uri")
    if uri is None:
        uri = element.child("filename")  # SDF 1.2's word, still seen in newer files
    if uri is None:
        raise element.error("<mesh> needs a <uri>, such as model://table/meshes/table.dae")
    file = reading.file_of(uri, subject, "this shape is left out, not its body")
    if file is None:
        return None
    x, y, z = vector(element, "scale", (1.0, 1.0, 1.0))
    if min(abs(x), abs(y), abs(z)) < 1e-9:
        raise element.error("<mesh> has a scale of 0")
    name = element.find("submesh/name")
    return MeshFile(
        file,
        (x, y, z),
        name.text if name is not None else "",
        flag(element, "submesh/center"),
    )


def _material(element: Element, subject: str, reading: Reading) -> Material:
    """The colour by <diffuse>, <ambient> or a script, and a picture of it."""
    material = element.child("material")
    if material is None:
        return Material()
    list_leftovers(material, subject, ("ambient", "diffuse", "script", "pbr"), reading.deviations)
    color = color_of(material, "diffuse")
    picture = _picture(material, subject, reading)
    script = material.child("script")
    if script is not None and (name := script.child("name")) is not None and name.text:
        uris = [(uri.text, uri.place) for uri in script.all("uri") if uri.text]
        named = reading.scripts.find(name.text, uris)
        if named is None and color is None and picture is None:
            reading.deviations.changed(
                name.place, subject, f"material {name.text!r} is not known", "it is drawn in grey"
            )
        elif named is not None:
            color, picture = color or named.color, picture or named.texture
    return Material(color or color_of(material, "ambient"), picture)


def _picture(material: Element, subject: str, reading: Reading) -> Path | None:
    """The picture of physically based rendering's colour."""
    for path in _PBR_COLORS:
        uri = material.find(path)
        if uri is not None and uri.text:
            return reading.file_of(uri, subject, "it is drawn in its plain colour")
    return None


def _friction(element: Element, subject: str, reading: Reading) -> float | None:
    surface = element.child("surface")
    if surface is None:
        return None
    list_leftovers(surface, subject, ("friction",), reading.deviations)
    friction = surface.child("friction")
    if friction is not None:
        list_leftovers(friction, subject, ("ode",), reading.deviations)
    first = surface.find("friction/ode/mu")
    if first is None or not first.text:
        return None
    mu, second = number(surface, "friction/ode/mu", 1.0), number(surface, "friction/ode/mu2", -1.0)
    if second >= 0.0 and second != mu:
        reading.deviations.changed(
            first.place,
            subject,
            f"friction {mu:g} along, {second:g} across",
            "the smaller one holds in every direction",
        )
        mu = min(mu, second)
    return max(mu, 0.0)
