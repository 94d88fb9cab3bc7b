"""Check that the masses and inertias of a URDF are physically possible."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from lxml import etree

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.formats.urdf import linked
from momantu_bt.geometry import Array, Transform
from momantu_bt.robots.parts import line_of
from momantu_bt.robots.robot_file import BoxInertial

TRIANGLE_SLACK = 0.01
"""Rounding may bring one principal inertia above the sum of the others by this relative amount."""
DENSITY = 500.0
"""Density of the box around a part, kg/m3: light metal housings with motors, and much air."""


def inertia_problems(root: etree._Element, file: str = "") -> list[Problem]:
    """The problems of masses and inertias of a URDF's links, each at its line.

    An error: no physical body has these values. A warning: the values are only unlikely.
    file: the URDF's name in the places.
    """
    found = []
    for link, error, code, message, hint in _of_links(root):
        severity = Severity.ERROR if error else Severity.WARNING
        found.append(Problem(code, message, Place(file, line_of(link)), hint, severity))
    return found


def impossible_inertials(root: etree._Element) -> dict[str, str]:
    """What is wrong with masses and inertias that no body has, by link name."""
    return {str(link.get("name")): said for link, error, _, said, _ in _of_links(root) if error}


def _of_links(root: etree._Element) -> Iterator[tuple[etree._Element, bool, str, str, str]]:
    moving = {
        linked(joint, "child") for joint in root.findall("joint") if joint.get("type") != "fixed"
    }
    for link in root.findall("link"):
        for found in _of_link(link, link.get("name") in moving):
            yield (link, *found)


def replace_inertial(link: etree._Element, given: BoxInertial) -> None:
    """Give a link the mass and the inertia of a solid box."""
    for old in link.findall("inertial"):
        link.remove(old)
    new = etree.SubElement(link, "inertial")
    etree.SubElement(new, "origin", xyz=" ".join(f"{v:.9g}" for v in given.xyz), rpy="0 0 0")
    etree.SubElement(new, "mass", value=f"{given.mass:.9g}")
    x, y, z = given.box
    own = [given.mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))]
    inertia = etree.SubElement(new, "inertia", ixy="0", ixz="0", iyz="0")
    for key, value in zip(("ixx", "iyy", "izz"), own, strict=True):
        inertia.set(key, f"{value:.9g}")


def _of_link(link: etree._Element, moves: bool) -> Iterator[tuple[bool, str, str, str]]:
    name = repr(link.get("name"))
    mass, inertia = _mass(link), _inertia(link)
    solid = link.find("collision") is not None
    if mass is not None and mass < 0.0:
        yield True, "negative-mass", f"{name} has a mass of {mass:g} kg", _proposal(link, None)
        return
    if not mass:
        if solid:
            how = "moves and has a collision shape, but no mass"
            how = how if moves else "has a collision shape, but no mass"
            yield moves, "no-inertia", f"{name} {how}", _proposal(link, None)
        return
    if inertia is None:
        yield moves, "no-inertia", f"{name} has a mass, but no inertia", _proposal(link, mass)
        return
    least, middle, most = np.linalg.eigvalsh(inertia)
    if least <= 0.0:
        what = f"the inertia of {name} is not positive definite (principal values "
        what += f"{least:.3g}, {middle:.3g}, {most:.3g})"
        # a link that is fixed to another may have none, but not an impossible one
        yield moves or bool(inertia.any()), "bad-inertia", what, _proposal(link, mass)
    elif most > (least + middle) * (1.0 + TRIANGLE_SLACK):
        what = f"no body has the inertia of {name}: the largest principal value {most:.3g} is "
        what += f"more than the sum of the others, {least + middle:.3g}"
        yield False, "unlikely-inertia", what, _proposal(link, mass)


def _mass(link: etree._Element) -> float | None:
    element = link.find("inertial/mass")
    return None if element is None else float(element.get("value", "0"))


def _inertia(link: etree._Element) -> Array | None:
    element = link.find("inertial/inertia")
    if element is None:
        return None
    xx, xy, xz, yy, yz, zz = (
        float(element.get(key, "0")) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _proposal(link: etree._Element, mass: float | None) -> str:
    """The inertial of a solid box around the link's primitive shapes, ready to be written."""
    low, high = _bounds(link)
    if not np.isfinite(low).all():
        return (
            "write an <inertial> with its mass m, and of the box x, y, z around it ixx = "
            "m/12 (y*y + z*z), iyy = m/12 (x*x + z*z), izz = m/12 (x*x + y*y)"
        )
    x, y, z = high - low
    m = DENSITY * x * y * z if mass is None else mass
    center = " ".join(f"{value + 0.0:.4g}" for value in (low + high) / 2)
    xx, yy, zz = (m / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y)))
    return (
        f'write <inertial><origin xyz="{center}"/><mass value="{m:.4g}"/><inertia ixx="{xx:.3g}" '
        f'ixy="0" ixz="0" iyy="{yy:.3g}" iyz="0" izz="{zz:.3g}"/></inertial>, which is that of a '
        f"solid box around it{'' if mass is not None else '; weigh the real one'}"
    )


def _bounds(link: etree._Element) -> tuple[Array, Array]:
    """Lowest and highest corner of all primitive collision shapes in the link's frame."""
    low, high = np.full(3, math.inf), np.full(3, -math.inf)
    for collision in link.findall("collision"):
        half = _half_extent(collision)
        if half is None:
            continue
        origin = collision.find("origin")
        xyz, rpy = (
            [0.0, 0.0, 0.0]
            if origin is None
            else [float(v) for v in origin.get(k, "0 0 0").split()]
            for k in ("xyz", "rpy")
        )
        pose = Transform.from_rpy(xyz, rpy)
        reach = np.abs(pose.rotation) @ half
        low, high = np.minimum(low, pose.position - reach), np.maximum(high, pose.position + reach)
    return low, high


def _half_extent(collision: etree._Element) -> Array | None:
    shape = collision.find("geometry/*")
    if shape is None or shape.tag not in ("box", "cylinder", "sphere"):
        return None
    if shape.tag == "box":
        return np.array([float(v) / 2 for v in shape.get("size", "").split()])
    radius = float(shape.get("radius", "0"))
    tall = radius if shape.tag == "sphere" else float(shape.get("length", "0")) / 2
    return np.array([radius, radius, tall])
