"""URDF files as links and joints, their numbers and limits checked; https://wiki.ros.org/urdf/XML."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeAlias

from lxml import etree

from momantu_bt.errors import MomantuError

Triple: TypeAlias = tuple[float, float, float]

SHAPES = ("mesh", "box", "cylinder", "sphere")


class UrdfError(MomantuError, ValueError):
    """A file is not a URDF file, or has a text where a number belongs; the message says where."""


@dataclass(frozen=True, slots=True)
class Shape:
    """One `visual` or `collision` of a link. kind: mesh, box, cylinder or sphere.

    xyz (m), rpy (rad): its pose in the link. size: scale of a mesh; of a box the edges, of a
    cylinder (radius, length, 0), of a sphere (radius, 0, 0), all in m. mesh: the address of the
    mesh file, as written in the URDF.
    """

    kind: str
    xyz: Triple
    rpy: Triple
    size: Triple
    mesh: str = ""


@dataclass(frozen=True, slots=True)
class Link:
    """One link. mass: kg, 0 if the file gives none. visuals, collisions: how many it has.

    shapes: its collision shapes, as far as their kind is known.
    """

    name: str
    mass: float
    visuals: int
    collisions: int
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Mimic:
    """A joint that follows `leader`: its position is multiplier * leader's position + offset."""

    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint; kind is URDF's type. xyz (m), rpy (rad): pose of the child's frame in the parent.

    lower, upper: rad or m. velocity: rad/s or m/s. effort: Nm or N. None: not in the file.
    """

    name: str
    kind: str
    parent: str
    child: str
    xyz: Triple
    rpy: Triple
    axis: Triple
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    mimic: Mimic | None = None


class Urdf:
    """A URDF. `links` and `joints` are in file order and are read at their first use.

    Both raise UrdfError if the file has a text where a number belongs.
    """

    def __init__(self, root: etree._Element) -> None:
        """root: the file's `robot` element; it is not changed."""
        self.root = root

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """Every link."""
        return tuple(_link(element) for element in self.root.findall("link"))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Every joint."""
        return tuple(_joint(element) for element in self.root.findall("joint"))

    @property
    def mass(self) -> float:
        """The mass of all links, kg."""
        return sum(link.mass for link in self.links)


def read_urdf(path: Path) -> Urdf:
    """Read a URDF file.

    Raises:
        OSError: the file cannot be read.
        UrdfError: the file is not XML.
    """
    return Urdf(parse_urdf(path.read_bytes(), str(path)))


def parse_urdf(text: bytes, file: str) -> etree._Element:
    """Read a URDF's text as a `robot` element that can be changed; other files are not read.

    Raises:
        UrdfError: the text is not XML. file: the URDF's name in this message.
    """
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True
    )
    try:
        return etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:
        raise UrdfError(f"{file} is not a URDF file, for it is not XML: {error.msg}") from None


def linked(joint: etree._Element, end: str) -> str:
    """The link at the `parent` or `child` end of a joint; empty if the joint names none."""
    return _attribute(joint, end, "link", "")


def _link(element: etree._Element) -> Link:
    name = element.get("name", "")
    mass = element.find("inertial/mass")
    return Link(
        name,
        0.0 if mass is None else _number(f"the link {name}", "mass", mass.get("value", "0")),
        len(element.findall("visual")),
        len(element.findall("collision")),
        tuple(_shapes(element, f"the link {name}")),
    )


def _shapes(link: etree._Element, said: str) -> Iterator[Shape]:
    for collision in link.findall("collision"):
        shape = collision.find("geometry/*")
        if shape is None or shape.tag not in SHAPES:
            continue
        yield Shape(
            str(shape.tag),
            _three(said, "xyz", _attribute(collision, "origin", "xyz", "0 0 0")),
            _three(said, "rpy", _attribute(collision, "origin", "rpy", "0 0 0")),
            _size(shape, said),
            shape.get("filename", ""),
        )


def _size(shape: etree._Element, said: str) -> Triple:
    if shape.tag == "mesh":
        return _three(said, "scale", shape.get("scale", "1 1 1"))
    if shape.tag == "box":
        return _three(said, "size", shape.get("size", ""))
    radius = _number(said, "radius", shape.get("radius", ""))
    return radius, _number(said, "length", shape.get("length", "0")), 0.0


def _joint(element: etree._Element) -> Joint:
    name = element.get("name", "")
    said = f"the joint {name}"

    def three(tag: str, attribute: str, default: str) -> Triple:
        return _three(said, attribute, _attribute(element, tag, attribute, default))

    return Joint(
        name,
        element.get("type", "fixed"),
        linked(element, "parent"),
        linked(element, "child"),
        three("origin", "xyz", "0 0 0"),
        three("origin", "rpy", "0 0 0"),
        three("axis", "xyz", "1 0 0"),
        _limit(element, said, "lower"),
        _limit(element, said, "upper"),
        _limit(element, said, "velocity"),
        _limit(element, said, "effort"),
        _mimic(element, said),
    )


def _limit(joint: etree._Element, said: str, name: str) -> float | None:
    text = _attribute(joint, "limit", name, "")
    value = _number(said, name, text) if text else None
    if value is not None and value < 0 and name in ("velocity", "effort"):
        raise UrdfError(f"{said} has {name}={text!r}; write a number of 0 or more")
    return value


def _mimic(joint: etree._Element, said: str) -> Mimic | None:
    mimic = joint.find("mimic")
    if mimic is None:
        return None
    ratio, offset = mimic.get("multiplier", "1"), mimic.get("offset", "0")
    return Mimic(
        mimic.get("joint", ""),
        _number(said, "multiplier", ratio),
        _number(said, "offset", offset),
    )


def _attribute(element: etree._Element, tag: str, name: str, default: str) -> str:
    child = element.find(tag)
    return default if child is None else str(child.get(name, default))


def _number(said: str, name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UrdfError(f"{said} has {name}={text!r}; write a number")
    return value


def _three(said: str, name: str, text: str) -> Triple:
    numbers = [_number(said, name, part) for part in text.split()]
    if len(numbers) != 3:
        raise UrdfError(f"{said} has {name}={text!r}; write three numbers")
    a, b, c = numbers
    return a, b, c
