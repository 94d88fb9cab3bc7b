"""Prepare any URDF: find its meshes, leave out unusable parts and report them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from lxml import etree
from scipy.spatial import QhullError

from momantu_bt.formats.urdf import Urdf
from momantu_bt.geometry import Array
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.inertia import DENSITY, impossible_inertials, replace_inertial
from momantu_bt.robots.packages import Packages
from momantu_bt.robots.parts import MOST_BYTES, load_part
from momantu_bt.robots.robot_file import BoxInertial, PartSource
from momantu_skills.manipulation.model.hulls import hull_points, part_points
from momantu_skills.manipulation.model.urdf import BaseUrdf, CollisionPart, base_urdf
from momantu_skills.robot_setup.urdf.skeleton import (
    MOVING,
    TURNING,
    SetupError,
    Skeleton,
    read_skeleton,
)

SOLIDS = ("box", "cylinder", "sphere", "mesh")
HALF_TURN = "3.14159"
"""Range of a hinge without limits, rad."""
LEAST_EDGE = 0.01
"""Least edge of the box whose inertia a link gets, m."""
LEAST_MASS = 0.01
"""Least mass of such a link, kg."""
LEAST_ROOM = 1e-4
"""Least range of a joint, rad or m; a joint with less is fixed, and so are slides without
limits."""


@dataclass(frozen=True)
class Given:
    """How a URDF is read: arguments of a xacro file, folders of packages, mended inertials."""

    args: Mapping[str, str] = field(default_factory=dict)
    package_path: tuple[Path, ...] = ()
    inertials: Mapping[str, BoxInertial] = field(default_factory=dict)


@dataclass(frozen=True)
class Prepared:
    """A URDF that is ready for analysis.

    kind: urdf or xacro. urdf: the cleaned copy. notes: what was left out, and why. given: what the
    robot file must say of the URDF, so that it is found and read again.
    """

    source: Path
    kind: str
    urdf: Path
    skeleton: Skeleton
    document: etree._Element
    notes: tuple[str, ...]
    given: Given


@dataclass
class Placed:
    """A cleaned URDF and the link that serves as its base; see `UrdfSource`."""

    urdf: Path
    base_frame: str
    mesh_directories: tuple[Path, ...] = ()

    def cut(self) -> BaseUrdf:
        """The links below the base."""
        return base_urdf(self)


@dataclass
class _Notes:
    lines: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)

    def all(self) -> tuple[str, ...]:
        if not self.missing:
            return tuple(self.lines)
        if len(self.missing) == 1:
            said = f"the collision mesh {self.missing[0]} was not found and is left out: its link "
            return (*self.lines, f"{said}has no shape until the file lies where the URDF says")
        names = ", ".join(self.missing[:3]) + (", …" if len(self.missing) > 3 else "")
        return (
            *self.lines,
            f"{len(self.missing)} collision meshes were not found and are left out ({names}): "
            "the links have no shape until the files lie where the URDF says",
        )


def prepare(source: Path, folder: Path, given: Given | None = None) -> Prepared:
    """Read a URDF or a xacro file, and write a copy into `folder` that planning's readers take.

    given: arguments and packages, if there are any.

    Raises:
        SetupError: it is neither, or not one robot.
    """
    kind = "xacro" if _is_xacro(source) else "urdf"
    try:
        file = str(source.resolve())
        asked = given or Given()
        args: dict[str, str | bool | int | float] = dict(asked.args)
        if kind == "xacro":
            as_part = PartSource(xacro=file, args=args)
        elif args:
            raise SetupError(f"{source} is no xacro file: it takes no arguments")
        else:
            as_part = PartSource(urdf=file)
        part = load_part("robot", as_part, source.parent, None, asked.package_path)
    except PartError as error:
        raise SetupError(str(error)) from None
    root = part.root
    skeleton = read_skeleton(Urdf(root))
    notes = _Notes()
    for joint in root.findall("joint"):
        _mend_joint(joint, notes)
    for link in root.findall("link"):
        for collision in link.findall("collision"):
            _mend_shape(link, collision, part.packages, notes)
    path = folder / "robot.urdf"
    path.write_bytes(etree.tostring(root))
    _drop_flat(root, path, skeleton.root, notes)
    inertials = _mend_inertials(root, path, skeleton.root, notes)
    path.write_bytes(etree.tostring(root))
    known = replace(asked, inertials=inertials)
    return Prepared(source, kind, path, read_skeleton(Urdf(root)), root, notes.all(), known)


def _is_xacro(source: Path) -> bool:
    """Recognized by its ending or by xacro's elements; expanded files only mention xacro."""
    if source.suffix == ".xacro":
        return True
    try:
        with source.open("rb") as file:
            return b"<xacro:" in file.read(MOST_BYTES)
    except OSError:
        return False


def _mend_joint(joint: etree._Element, notes: _Notes) -> None:
    name, kind = joint.get("name"), joint.get("type", "fixed")
    if kind in ("floating", "planar"):
        return
    if kind not in (*MOVING, "fixed"):
        notes.lines.append(f"the joint {name} is of the unknown type {kind!r}; taken as fixed")
        joint.set("type", "fixed")
        return
    limit = joint.find("limit")
    if kind in ("revolute", "prismatic") and (
        limit is None or limit.get("lower") is None or limit.get("upper") is None
    ):
        notes.lines.append(f"the joint {name} has no limits in the URDF")
        limit = etree.SubElement(joint, "limit") if limit is None else limit
        far = HALF_TURN if kind in TURNING else "0"
        limit.set("lower", limit.get("lower", f"-{far}"))
        limit.set("upper", limit.get("upper", far))
    if limit is not None and _is_stuck(kind, limit):
        notes.lines.append(f"the limits of the joint {name} leave it no room; taken as fixed")
        joint.set("type", "fixed")
    if limit is not None:
        for what in ("effort", "velocity"):
            limit.set(what, limit.get(what, "0"))


def _is_stuck(kind: str, limit: etree._Element) -> bool:
    """Whether a joint cannot move; a hinge from 0 to 0 counts as one without limits."""
    if kind not in ("revolute", "prismatic"):
        return False
    room = float(limit.get("upper", "0")) - float(limit.get("lower", "0"))
    return room < LEAST_ROOM and (kind == "prismatic" or room > 0)


def _mend_shape(
    link: etree._Element, collision: etree._Element, packages: Packages, notes: _Notes
) -> None:
    shape = collision.find("geometry/*")
    if shape is None or shape.tag not in SOLIDS:
        what = "nothing" if shape is None else f"<{shape.tag}>"
        notes.lines.append(f"a collision of {link.get('name')} is {what}; left out")
        link.remove(collision)
    elif shape.tag == "mesh":
        path = packages.mesh(shape.get("filename", ""))
        if path is None:
            notes.missing.append(shape.get("filename", ""))
            link.remove(collision)
        else:
            shape.set("filename", str(path.resolve()))


def _drop_flat(root: etree._Element, path: Path, base: str, notes: _Notes) -> None:
    """Remove shapes without volume and unreadable ones, as they have no hull."""
    links = {link.get("name"): link for link in root.findall("link")}
    left = {name: list(link.findall("collision")) for name, link in links.items()}
    for part in Placed(path, base).cut().parts:
        element = left[part.link].pop(0)
        reason = _unusable(part)
        if reason is not None:
            links[part.link].remove(element)
            notes.lines.append(f"a collision {part.kind} of {part.link} {reason}; left out")


def _unusable(part: CollisionPart) -> str | None:
    try:
        points = part_points(part)
        if not np.isfinite(points).all():
            return "has coordinates that are not numbers"
        hull_points(points)
    except (QhullError, ValueError):
        return "has no volume"
    except Exception as error:  # the mesh reader raises whatever its libraries raise
        return f"cannot be read ({error})"
    return None


def _mend_inertials(
    root: etree._Element, path: Path, base: str, notes: _Notes
) -> dict[str, BoxInertial]:
    """Give links with an impossible mass or inertia that of the solid box around their shapes."""
    wrong = impossible_inertials(root)
    if not wrong:
        return {}
    path.write_bytes(etree.tostring(root))
    corners: dict[str, list[Array]] = {}
    for part in Placed(path, base).cut().parts:
        corners.setdefault(part.link, []).append(part_points(part))
    links = {str(link.get("name")): link for link in root.findall("link")}
    found = {}
    for name, message in wrong.items():
        points = np.vstack(corners.get(name, [np.zeros((1, 3))]))
        found[name] = _box(points, links[name])
        replace_inertial(links[name], found[name])
        notes.lines.append(
            f"{message}; it gets {found[name].mass:g} kg, as a solid box around its shapes"
        )
    return found


def _box(points: Array, link: etree._Element) -> BoxInertial:
    """The solid box around points (n, 3), of the link's own mass where it has one."""
    low, high = points.min(axis=0), points.max(axis=0)
    edges = np.maximum(high - low, LEAST_EDGE)
    own = link.find("inertial/mass")
    mass = 0.0 if own is None else float(own.get("value", "0"))
    mass = max(mass if mass > 0.0 else DENSITY * float(np.prod(edges)), LEAST_MASS)
    x, y, z = (round(float(edge), 4) for edge in edges)
    a, b, c = (round(float(middle), 4) + 0.0 for middle in (low + high) / 2)
    return BoxInertial(mass=round(mass, 4), box=(x, y, z), xyz=(a, b, c))
