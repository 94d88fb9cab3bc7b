"""A robot's URDF in the form that planning needs: rooted at the base, one angle per joint."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from lxml import etree

from momantu_bt.formats.urdf import Link, Urdf, linked, parse_urdf
from momantu_bt.geometry import Transform


class UrdfSource(Protocol):
    """What reading a URDF needs; a robot's description provides it."""

    @property
    def urdf(self) -> Path:
        """Absolute path of the file."""
        ...

    @property
    def base_frame(self) -> str:
        """The root link."""
        ...

    @property
    def mesh_directories(self) -> tuple[Path, ...]:
        """The folders in which `package://` addresses are searched."""
        ...


@dataclass(frozen=True)
class CollisionPart:
    """One collision element of a link. kind: mesh, box, cylinder or sphere.

    size: (3,) mesh scale; box edges; (radius, length, 0); (radius, 0, 0). m.
    """

    link: str
    kind: str
    link_from_part: Transform
    size: tuple[float, float, float]
    mesh: Path | None = None


@dataclass(frozen=True)
class BaseUrdf:
    """text: URDF without anything above the base, continuous joints as revolute ones.

    continuous: names of the joints that turn without limit.
    """

    text: str
    continuous: tuple[str, ...]
    parts: tuple[CollisionPart, ...]


def base_urdf(description: UrdfSource) -> BaseUrdf:
    """Reduce a URDF to what is below the base frame.

    Virtual joints above the base would add degrees of freedom. Pinocchio gives continuous joints
    two coordinates, and URDF readers take their limits as (0, 0). Therefore they become revolute
    here with limits of +-pi, and planners treat their range as endless.
    """
    root = parse_urdf(description.urdf.read_bytes(), str(description.urdf))
    keep = _links_below(root, description.base_frame)
    continuous: list[str] = []
    for joint in root.findall("joint"):
        if linked(joint, "child") not in keep - {description.base_frame}:
            root.remove(joint)
        elif joint.get("type") == "continuous":
            continuous.append(str(joint.get("name")))
            _make_revolute(joint)
    for link in root.findall("link"):
        if link.get("name") not in keep:
            root.remove(link)
    parts = tuple(p for link in Urdf(root).links for p in _parts(link, description))
    return BaseUrdf(etree.tostring(root).decode(), tuple(continuous), parts)


def _links_below(root: etree._Element, base: str) -> set[str]:
    children: dict[str, list[str]] = {}
    for joint in root.findall("joint"):
        children.setdefault(linked(joint, "parent"), []).append(linked(joint, "child"))
    keep, waiting = {base}, [base]
    while waiting:
        for child in children.get(waiting.pop(), []):
            if child not in keep:
                keep.add(child)
                waiting.append(child)
    return keep


def _make_revolute(joint: etree._Element) -> None:
    joint.set("type", "revolute")
    limit = joint.find("limit")
    if limit is None:
        limit = etree.SubElement(joint, "limit", effort="1", velocity="1")
    limit.set("lower", repr(-math.pi))
    limit.set("upper", repr(math.pi))


def _parts(link: Link, description: UrdfSource) -> Iterator[CollisionPart]:
    for shape in link.shapes:
        place = Transform.from_rpy(shape.xyz, shape.rpy)
        mesh = _mesh_path(shape.mesh, description) if shape.kind == "mesh" else None
        yield CollisionPart(link.name, shape.kind, place, shape.size, mesh)


def _mesh_path(name: str, description: UrdfSource) -> Path:
    relative = name.removeprefix("package://").removeprefix("file://")
    folders = (description.urdf.parent, *description.mesh_directories)
    for folder in folders:
        if (folder / relative).is_file():
            return folder / relative
    looked = ", ".join(str(folder) for folder in folders)
    raise FileNotFoundError(f"{description.urdf} names the mesh {name!r}, which is not in {looked}")
