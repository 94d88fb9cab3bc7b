"""Join parts, mounts, frames and virtual base joints in one `robot` element."""

from __future__ import annotations

import copy
from collections.abc import Iterator

import numpy as np
from lxml import etree

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.urdf import Urdf, linked
from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Transform
from momantu_bt.robot_simulation import BaseJoints
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.parts import LoadedPart
from momantu_bt.robots.robot_file import Drive, Mount, RobotFile
from momantu_bt.robots.structure import root_link

VIRTUAL_JOINTS = BaseJoints(x="base_x_joint", y="base_y_joint", yaw="base_yaw_joint")
"""Names of the joints that are added above a base that has none of its own."""
_VIRTUAL_LINKS = ("base_origin", "base_x_link", "base_y_link")
_FAR, _FAST = "1000", "10"
"""Limits of the added slides, m and m/s: larger than any room and faster than any base."""
KEPT = ("link", "joint", "material")
"""Elements of a URDF that are kept; transmissions and extensions of other programs are not."""


class Joining:
    """Joins parts whose names have their namespaces already; `root` is the result."""

    def __init__(self, robot: RobotFile, parts: list[LoadedPart]) -> None:
        self.root = etree.Element("robot", name=robot.name)
        self._robot, self._parts = robot, parts
        self._owners: dict[tuple[str, str], tuple[str, str]] = {}

    def join(self) -> Iterator[PartError]:
        """Do it; yields what is wrong."""
        for part in self._parts:
            yield from self._take(part)
        yield from self._missing_mounts()
        for name in self._robot.frames:
            yield from self._new_link(name, ("frames", name))
        first = self._parts[0]
        if first.name in self._robot.mounts:
            yield from self._new_link(self._robot.base_frame, ("mounts", first.name, "on"))
        for part in self._parts:
            mount = self._robot.mounts.get(part.name)
            if mount is not None:
                yield from self._mount(part, mount)
        for name, frame in self._robot.frames.items():
            yield from self._unknown_link(frame.on, ("frames", name, "on"))
            pose = Transform.from_rpy(frame.xyz, frame.rpy)
            yield from self._fix(f"{name}_joint", frame.on, name, pose, ("frames", name))
        yield from self._rings()
        drive = self._robot.base.drive
        if drive is not None and drive.joints is None:
            yield from self._carry(drive)

    def _take(self, part: LoadedPart) -> Iterator[PartError]:
        for element in part.root:
            tag = str(element.tag)
            if tag not in KEPT:
                continue
            if tag in ("link", "joint", "material"):
                text = etree.tostring(element, method="c14n").decode().strip()
                name = str(element.get("name"))
                owner, known = self._owners.setdefault((tag, name), (part.name, text))
                if tag == "material" and owner != part.name and known == text:
                    continue
                if owner != part.name:
                    yield PartError(("parts", part.name), _twice(tag, name, owner, part))
            self.root.append(copy.deepcopy(element))

    def _missing_mounts(self) -> Iterator[PartError]:
        first, *others = self._robot.parts
        for name in others:
            if name not in self._robot.mounts:
                where = f"write `mounts: {{{name}: {{on: LINK, xyz: [0, 0, 0]}}}}`"
                yield PartError(("parts", name), f"the part {name!r} has no mount; {where}")
        for name in self._robot.mounts:
            if name not in self._robot.parts:
                said = f"there is no part {name!r}; {valid_names(name, self._robot.parts, 'parts')}"
                yield PartError(("mounts", name), said)
        mount = self._robot.mounts.get(first)
        if mount is not None and mount.on != self._robot.base_frame:
            yield PartError(
                ("mounts", first, "on"),
                f"{first!r} is the first part: it can only be put on a base frame of its own, the "
                f"one that `base_frame` names, {self._robot.base_frame!r}",
            )

    def _mount(self, part: LoadedPart, mount: Mount) -> Iterator[PartError]:
        place: KeyPath = ("mounts", part.name)
        if part is not self._parts[0]:
            yield from self._unknown_link(mount.on, (*place, "on"))
        root, pose = root_link(part), Transform.from_rpy(mount.xyz, mount.rpy)
        if mount.link is not None:
            try:
                pose = pose @ _root_from_link(part, root, mount.link).inverse()
            except PartError as error:
                yield error
        yield from self._fix(f"{part.name}_mount", mount.on, root, pose, place)

    def _fix(
        self, name: str, parent: str, child: str, pose: Transform, place: KeyPath
    ) -> Iterator[PartError]:
        yield from self._taken("joint", name, place)
        self._joint(name, "fixed", parent, child, pose)

    def _new_link(self, name: str, place: KeyPath) -> Iterator[PartError]:
        yield from self._taken("link", name, place)
        etree.SubElement(self.root, "link", name=name)

    def _taken(self, tag: str, name: str, place: KeyPath) -> Iterator[PartError]:
        owner, _ = self._owners.setdefault((tag, name), (str(place[0]), ""))
        if name in self._names(tag):
            yield PartError(place, f"the {tag} {name!r} is in {owner} already; choose another name")

    def _names(self, tag: str) -> list[str]:
        return [str(element.get("name")) for element in self.root.findall(tag)]

    def _unknown_link(self, name: str, place: KeyPath) -> Iterator[PartError]:
        links = self._names("link")
        if name not in links:
            yield PartError(
                place, f"there is no link {name!r}; {valid_names(name, links, 'links')}"
            )

    def _joint(
        self, name: str, kind: str, parent: str, child: str, pose: Transform
    ) -> etree._Element:
        joint = etree.SubElement(self.root, "joint", name=name, type=kind)
        etree.SubElement(joint, "origin", xyz=numbers(pose.position), rpy=numbers(pose.rpy))
        etree.SubElement(joint, "parent", link=parent)
        etree.SubElement(joint, "child", link=child)
        return joint

    def _rings(self) -> Iterator[PartError]:
        """Parts and frames that are fixed to each other, and so to nothing."""
        above = {linked(j, "child"): linked(j, "parent") for j in self.root.findall("joint")}
        fixed: list[tuple[str, str, str]] = []
        fixed += [("mounts", name, mount.on) for name, mount in self._robot.mounts.items()]
        fixed += [("frames", name, frame.on) for name, frame in self._robot.frames.items()]
        for section, name, on in fixed:
            seen: set[str] = set()
            link = on
            while link in above and link not in seen:
                seen.add(link)
                link = above[link]
            if link in seen:
                said = f"{name!r} hangs on {on!r}, and that in the end on itself: a ring"
                yield PartError((section, name, "on"), said)

    def _carry(self, drive: Drive) -> Iterator[PartError]:
        """Add the joints x, y and yaw above the base frame."""
        base, first = self._robot.base_frame, self._parts[0]
        top = base if first.name in self._robot.mounts else root_link(first)
        if top != base:
            yield PartError(
                ("base_frame",),
                f"the base frame {base!r} is not the root of {first.name!r}, which is {top!r}; "
                "name that, or put the part on a base frame of its own under `mounts`, or name the "
                "URDF's own virtual joints under `base.drive.joints`",
            )
            return
        place: KeyPath = ("base", "drive")
        for link in _VIRTUAL_LINKS:
            yield from self._new_link(link, place)
        above = (*_VIRTUAL_LINKS, base)
        axes = (("prismatic", "1 0 0"), ("prismatic", "0 1 0"), ("continuous", "0 0 1"))
        names = (VIRTUAL_JOINTS.x, VIRTUAL_JOINTS.y, VIRTUAL_JOINTS.yaw)
        for i, (name, (kind, axis)) in enumerate(zip(names, axes, strict=True)):
            yield from self._taken("joint", name, place)
            joint = self._joint(name, kind, above[i], above[i + 1], Transform())
            etree.SubElement(joint, "axis", xyz=axis)
            if kind == "prismatic":
                limit = etree.SubElement(joint, "limit", lower=f"-{_FAR}", upper=_FAR)
                limit.set("effort", f"{drive.force:g}")
                limit.set("velocity", _FAST)


def _twice(tag: str, name: str, owner: str, part: LoadedPart) -> str:
    said = f"{owner!r} and {part.name!r} both have a {tag} called {name!r}"
    return f"{said}; give one of them a namespace, such as `namespace: {part.name}`"


def _root_from_link(part: LoadedPart, root: str, link: str) -> Transform:
    """The pose of a link below its part's root, through fixed joints only."""
    place: KeyPath = ("mounts", part.name, "link")
    names = [str(each.get("name")) for each in part.root.findall("link")]
    within = f"{part.source.namespace}_{link}"
    link = within if link not in names and within in names else link
    if link not in names:
        raise PartError(
            place, f"{part.name!r} has no link {link!r}; {valid_names(link, names, 'links')}"
        )
    tree = KinematicTree.of_urdf(Urdf(part.root), root)
    moving = [joint.name for joint in tree.chain(link) if joint.kind != "fixed"]
    if moving:
        said = f"{link!r} moves against the part's root {root!r}, by {', '.join(moving)}"
        raise PartError(place, f"{said}; name a link that does not")
    return tree.base_from_frame(link, {})


def numbers(values: object) -> str:
    """Numbers as URDF's attributes have them."""
    return " ".join(repr(round(float(value), 12) + 0.0) for value in np.asarray(values))
