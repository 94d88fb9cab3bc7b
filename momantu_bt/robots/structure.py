"""Check that a part's URDF is one tree of links with valid numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lxml import etree

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.urdf import linked
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.limits import LIMITED
from momantu_bt.robots.parts import LoadedPart, line_of

JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic")
"""Joints with at most one coordinate; nothing here can drive `planar` and `floating` joints."""
_THREE = (("origin", "xyz"), ("origin", "rpy"), ("axis", "xyz"))
_SHAPES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def wrong_structure(part: LoadedPart) -> Iterator[str]:
    """The problems of a URDF, each with file and line."""
    links = [str(link.get("name")) for link in part.root.findall("link")]
    for tag in ("link", "joint"):
        seen: set[str] = set()
        for element in part.root.findall(tag):
            name = str(element.get("name"))
            if name in seen:
                where = part.where(line_of(element))
                yield f"{where}: a second {tag} is called {name!r}; rename one"
            seen.add(name)
    carried: dict[str, str] = {}
    for joint in part.root.findall("joint"):
        where = part.where(line_of(joint))
        yield from (f"{where}: {said}" for said in _of_joint(joint, links, carried))
    for link in part.root.findall("link"):
        where = part.where(line_of(link))
        yield from (f"{where}: {said}" for said in _of_link(link))


def _of_joint(joint: etree._Element, links: list[str], carried: dict[str, str]) -> Iterator[str]:
    name, kind = joint.get("name"), joint.get("type")
    if kind not in JOINT_TYPES:
        yield f"the joint {name!r} is of type {kind!r}; possible: {', '.join(JOINT_TYPES)}"
    for end in ("parent", "child"):
        link = linked(joint, end)
        if link not in links:
            said = f"the joint {name!r} has the {end} {link!r}, and there is no such link"
            yield f"{said}; {valid_names(link, links, 'links')}"
    child = linked(joint, "child")
    first = carried.setdefault(child, str(name))
    if first != name:
        yield f"the link {child!r} hangs on two joints, {first!r} and {name!r}"
    for tag, attribute in _THREE:
        yield from _unreadable(joint.find(tag), attribute, 3, f"the joint {name!r}")
    axis = None if kind == "fixed" else joint.find("axis")
    if axis is not None and _numbers(axis.get("xyz", "1 0 0")) == [0.0, 0.0, 0.0]:
        yield f"the joint {name!r} has the axis 0 0 0"
    yield from _of_limit(joint, f"the joint {name!r}")


def _of_limit(joint: etree._Element, said: str) -> Iterator[str]:
    limit = joint.find("limit")
    if limit is None:
        return
    numbers = {}
    for attribute in ("lower", "upper", "velocity", "effort"):
        yield from _unreadable(limit, attribute, 1, said)
        numbers[attribute] = next(iter(_numbers(limit.get(attribute, "0"))), 0.0)
    low, high = numbers["lower"], numbers["upper"]
    if joint.get("type") in LIMITED and low > high:
        yield f"{said} goes from lower={low:g} to upper={high:g}; lower must not be above upper"
    for attribute in ("velocity", "effort"):
        if numbers[attribute] < 0.0:
            value = f"{numbers[attribute]:g}"
            yield f"{said} has the limit {attribute}={value}; write one above 0, or 0 for none"


def _of_link(link: etree._Element) -> Iterator[str]:
    said = f"the link {link.get('name')!r}"
    for element in (*link.findall("visual"), *link.findall("collision"), *link.findall("inertial")):
        for attribute in ("xyz", "rpy"):
            yield from _unreadable(element.find("origin"), attribute, 3, said)
    for geometry in (*link.findall("visual/geometry"), *link.findall("collision/geometry")):
        for shape, attributes in _SHAPES.items():
            found = geometry.find(shape)
            if found is None:
                continue
            for attribute in attributes:
                count = 3 if shape == "box" else 1
                yield from _unreadable(found, attribute, count, said, needed=True)
                if min(_numbers(found.get(attribute, "")) or [1.0]) <= 0.0:
                    yield f"{said} has a {shape} whose {attribute} is not above 0"
        mesh = geometry.find("mesh")
        if mesh is not None:
            yield from _unreadable(mesh, "scale", 3, said)
    inertial = link.find("inertial")
    if inertial is not None:
        yield from _unreadable(inertial.find("mass"), "value", 1, said, needed=True)
        for attribute in _INERTIA:
            yield from _unreadable(inertial.find("inertia"), attribute, 1, said)


def _unreadable(
    element: etree._Element | None, attribute: str, count: int, said: str, *, needed: bool = False
) -> Iterator[str]:
    text = None if element is None else element.get(attribute)
    if element is None or (text is None and not needed):
        return
    if len(_numbers(text or "")) != count:
        what = "a number" if count == 1 else f"{count} numbers"
        yield f"{said}: {element.tag} has {attribute}={text!r}; expected {what}"


def _numbers(text: str) -> list[float]:
    """The finite numbers in a text; none when anything in it is not one."""
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        return []
    return numbers if all(map(math.isfinite, numbers)) else []


def root_link(part: LoadedPart) -> str:
    """The one link of a part that no joint carries, above all others.

    Raises:
        PartError: there is no such link, or there are several.
    """
    links = [str(link.get("name")) for link in part.root.findall("link")]
    below: dict[str, list[str]] = {}
    for joint in part.root.findall("joint"):
        below.setdefault(linked(joint, "parent"), []).append(linked(joint, "child"))
    carried = {child for children in below.values() for child in children}
    roots = [name for name in links if name not in carried]
    if len(roots) != 1:
        had = f"the roots {', '.join(roots)}" if roots else "joints in a ring, and no root"
        said = f"{part.path.name} is not a tree of links: it has {had}"
        raise PartError(("parts", part.name), said)
    reached, waiting = set(roots), list(roots)
    while waiting:
        for child in below.get(waiting.pop(), []):
            reached.add(child)
            waiting.append(child)
    if ring := [name for name in links if name not in reached]:
        said = f"{part.path.name} is not a tree of links: joints in a ring carry {', '.join(ring)}"
        raise PartError(("parts", part.name), said)
    return roots[0]
