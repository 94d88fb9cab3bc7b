"""Joining the parts of a robot into one URDF: namespaces, mounts, frames, virtual base joints."""

from __future__ import annotations

import copy
import difflib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from momantu_bt.descriptions.reading import Place
from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Transform
from momantu_bt.robot_simulation import BaseJoints
from momantu_bt.robots.cache import keep_urdf
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.meshes import locate_meshes, replace_meshes, users_folder
from momantu_bt.robots.naming import add_namespace
from momantu_bt.robots.parts import LoadedPart, load_part
from momantu_bt.robots.robot_file import Mount, RobotFile

VIRTUAL_JOINTS = BaseJoints(x="base_x_joint", y="base_y_joint", yaw="base_yaw_joint")
"""Names of the joints that are added above a base that has none of its own."""
_KEPT = ("link", "joint", "material", "transmission", "gazebo")
_LINK, _JOINT = "link", "joint"


@dataclass(frozen=True, slots=True)
class Assembled:
    """One URDF of a whole robot.

    root: its `robot` element. path: where it lies. base_joints: virtual joints of the base, the
    URDF's own or those that were added; None without a drive. files: what it was made from.
    """

    root: etree._Element
    path: Path
    mesh_directories: tuple[Path, ...]
    files: Mapping[str, Path]
    base_joints: BaseJoints | None


def assemble(robot: RobotFile, folder: Path) -> Assembled:
    """Join a robot's parts; where nothing is to be joined, the part's own file serves.

    Raises:
        ExceptionGroup[PartError]: everything that is wrong with the parts.
    """
    parts, troubles = _load_parts(robot, folder)
    _raise(troubles)
    drive = robot.base.drive
    joints = None if drive is None else drive.joints or VIRTUAL_JOINTS
    files = {name: path for part in parts for name, path in part.files.items()}
    own = parts[0]
    if _is_whole(robot):
        _raise(_mesh_troubles(parts, folder, rewrite=False))
        return Assembled(own.root, own.path, (own.path.parent,), files, joints)
    _raise(_mesh_troubles(parts, folder, rewrite=True))
    for part in parts:
        if part.source.namespace is not None:
            add_namespace(part.root, part.source.namespace)
    root = etree.Element("robot", name=robot.name)
    _raise(list(_Joining(robot, parts, root).join()))
    etree.cleanup_namespaces(root)
    etree.indent(root)
    path = keep_urdf(robot.name, etree.tostring(root, encoding="utf-8"))
    return Assembled(root, path, (), files, joints)


def _is_whole(robot: RobotFile) -> bool:
    """Whether the first part's file is the whole robot as it is."""
    (name, source), *others = robot.parts.items()
    drive = robot.base.drive
    changed = (
        source.xacro or source.namespace or users_folder(robot.name, name, source.meshes, Path())
    )
    added = others or robot.mounts or robot.frames or (drive is not None and drive.joints is None)
    return not (changed or added)


def _load_parts(robot: RobotFile, folder: Path) -> tuple[list[LoadedPart], list[PartError]]:
    parts, troubles = [], []
    for name, source in robot.parts.items():
        meshes = users_folder(robot.name, name, source.meshes, folder)
        try:
            parts.append(load_part(name, source, folder, meshes))
        except PartError as error:
            troubles.append(error)
    return parts, troubles


def _mesh_troubles(parts: list[LoadedPart], folder: Path, *, rewrite: bool) -> list[PartError]:
    troubles = []
    for part in parts:
        for message in replace_meshes(part):
            troubles.append(PartError(("parts", part.name, "meshes"), message))
        for message in locate_meshes(part, folder, rewrite=rewrite):
            troubles.append(PartError(("parts", part.name), message))
    return troubles


def _raise(troubles: list[PartError]) -> None:
    if troubles:
        raise ExceptionGroup("the robot cannot be assembled", troubles)


class _Joining:
    """Puts parts, mounts, frames and virtual joints into one element."""

    def __init__(self, robot: RobotFile, parts: list[LoadedPart], root: etree._Element) -> None:
        self._robot, self._parts, self._root = robot, parts, root
        self._owner: dict[tuple[str, str], str] = {}

    def join(self) -> Iterator[PartError]:
        """Do it; yields what is wrong."""
        for part in self._parts:
            yield from self._take(part)
        yield from self._unfit_mounts()
        roots: dict[str, str] = {}
        for part in self._parts:
            try:
                roots[part.name] = _root_link(part)
            except PartError as error:
                yield error
        if len(roots) < len(self._parts):
            return
        for part in self._parts:
            mount = self._robot.mounts.get(part.name)
            if mount is not None:
                yield from self._mount(part, mount, roots[part.name])
        for name, frame in self._robot.frames.items():
            place: Place = ("frames", name)
            yield from self._claim(_LINK, name, "frames", place)
            yield from self._unknown_link(frame.on, (*place, "on"))
            pose = Transform.from_rpy(frame.xyz, frame.rpy)
            self._fix(f"{name}_joint", frame.on, name, pose)
        yield from self._loose()
        yield from self._carry(roots[self._parts[0].name])

    def _take(self, part: LoadedPart) -> Iterator[PartError]:
        for element in part.root:
            if element.tag in (_LINK, _JOINT):
                name = str(element.get("name"))
                yield from self._claim(str(element.tag), name, part.name, ("parts", part.name))
            if element.tag in _KEPT:
                self._root.append(copy.deepcopy(element))

    def _claim(self, tag: str, name: str, owner: str, place: Place) -> Iterator[PartError]:
        first = self._owner.setdefault((tag, name), owner)
        taken = name in self._names(tag)
        if first != owner or taken:
            whose = f"in {first} and in {owner}" if first != owner else f"twice in {owner}"
            cure = f"; give one of them a namespace, such as `namespace: {owner}`"
            yield PartError(place, f"two {tag}s are called {name!r}: {whose}{cure}")

    def _names(self, tag: str) -> list[str]:
        return [str(element.get("name")) for element in self._root.findall(tag)]

    def _unfit_mounts(self) -> Iterator[PartError]:
        first, *others = self._robot.parts
        for name in others:
            if name not in self._robot.mounts:
                where = f"write `mounts: {{{name}: {{on: LINK, xyz: [0, 0, 0]}}}}`"
                yield PartError(("parts", name), f"the part {name!r} has no mount; {where}")
        for name in self._robot.mounts:
            if name not in self._robot.parts:
                yield PartError(
                    ("mounts", name), f"there is no part {name!r}{_near(name, self._robot.parts)}"
                )
        mount = self._robot.mounts.get(first)
        if mount is not None and mount.on != self._robot.base_frame:
            yield PartError(
                ("mounts", first, "on"),
                f"the first part can only be put on the base frame, {self._robot.base_frame!r}",
            )

    def _mount(self, part: LoadedPart, mount: Mount, root: str) -> Iterator[PartError]:
        place: Place = ("mounts", part.name)
        if part is self._parts[0]:
            yield from self._claim(_LINK, mount.on, "mounts", (*place, "on"))
            etree.SubElement(self._root, _LINK, name=mount.on)
        else:
            yield from self._unknown_link(mount.on, (*place, "on"))
            own = {str(link.get("name")) for link in part.root.findall(_LINK)}
            if mount.on in own:
                yield PartError((*place, "on"), f"{part.name} is mounted on itself: {mount.on!r}")
        pose = Transform.from_rpy(mount.xyz, mount.rpy)
        if mount.link is not None:
            try:
                pose = pose @ _root_from_link(part, root, mount.link).inverse()
            except PartError as error:
                yield error
        self._fix(f"{part.name}_mount", mount.on, root, pose)

    def _fix(self, name: str, parent: str, child: str, pose: Transform) -> None:
        if child not in self._names(_LINK):
            etree.SubElement(self._root, _LINK, name=child)
        self._joint(name, "fixed", parent, child, pose)

    def _joint(
        self, name: str, kind: str, parent: str, child: str, pose: Transform | None = None
    ) -> etree._Element:
        joint = etree.SubElement(self._root, _JOINT, name=name, type=kind)
        if pose is not None:
            xyz, rpy = _numbers(pose.position), _numbers(_rpy(pose))
            etree.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
        etree.SubElement(joint, "parent", link=parent)
        etree.SubElement(joint, "child", link=child)
        return joint

    def _unknown_link(self, name: str, place: Place) -> Iterator[PartError]:
        links = self._names(_LINK)
        links += [name for name in self._robot.frames if name not in links]
        if name not in links:
            yield PartError(place, f"there is no link {name!r}{_near(name, links)}")

    def _loose(self) -> Iterator[PartError]:
        """Parts and frames that are fixed in a ring, and so to nothing."""
        above = {
            _linked(joint, "child"): _linked(joint, "parent")
            for joint in self._root.findall(_JOINT)
        }
        fixed = [(("mounts", n), m.on) for n, m in self._robot.mounts.items()]
        fixed += [(("frames", n), f.on) for n, f in self._robot.frames.items()]
        for place, link in fixed:
            seen: set[str] = set()
            while link in above and link not in seen:
                seen.add(link)
                link = above[link]
            if link in seen:
                yield PartError(place, f"{place[1]} is fixed, in the end, to itself")

    def _carry(self, root: str) -> Iterator[PartError]:
        """Add the joints x, y and yaw above the base frame."""
        drive = self._robot.base.drive
        if drive is None or drive.joints is not None:
            return
        base = self._robot.base_frame
        top = base if self._parts[0].name in self._robot.mounts else root
        if top != base:
            yield PartError(
                ("base_frame",),
                f"the base frame {base!r} is not the first part's root, which is {root!r}; name "
                "that, or put the part on a base frame of its own under `mounts`, or name the "
                "URDF's own virtual joints under `base.drive.joints`",
            )
            return
        links = ("base_origin", "base_x_link", "base_y_link", base)
        joints = (VIRTUAL_JOINTS.x, VIRTUAL_JOINTS.y, VIRTUAL_JOINTS.yaw)
        for link in links[:-1]:
            yield from self._claim(_LINK, link, "base", ("base", "drive"))
            etree.SubElement(self._root, _LINK, name=link)
        kinds = (("prismatic", "1 0 0"), ("prismatic", "0 1 0"), ("continuous", "0 0 1"))
        for i, (kind, axis) in enumerate(kinds):
            yield from self._claim(_JOINT, joints[i], "base", ("base", "drive"))
            joint = self._joint(joints[i], kind, links[i], links[i + 1])
            etree.SubElement(joint, "axis", xyz=axis)
            if kind == "prismatic":
                force = f"{drive.force:g}"
                etree.SubElement(
                    joint, "limit", lower="-1000", upper="1000", effort=force, velocity="10"
                )


def _root_link(part: LoadedPart) -> str:
    """The one link of a part that no joint carries."""
    place: Place = ("parts", part.name)
    links = [str(link.get("name")) for link in part.root.findall(_LINK)]
    carried: set[str] = set()
    for joint in part.root.findall(_JOINT):
        for end in ("parent", "child"):
            name = _linked(joint, end)
            if name not in links:
                said = f"{part.where(joint)}: the joint {joint.get('name')!r} has as its {end} a "
                raise PartError(place, f"{said}link {name!r} that is not there{_near(name, links)}")
        carried.add(_linked(joint, "child"))
    roots = [name for name in links if name not in carried]
    if len(roots) != 1:
        said = "joints in a ring, and no root link" if not roots else f"roots: {', '.join(roots)}"
        raise PartError(place, f"{part.path.name} is no tree of links: it has {said}")
    return roots[0]


def _root_from_link(part: LoadedPart, root: str, link: str) -> Transform:
    """Where a link lies below its part's root, over fixed joints alone."""
    place: Place = ("mounts", part.name, "link")
    names = [str(each.get("name")) for each in part.root.findall(_LINK)]
    namespace = part.source.namespace
    if link not in names and namespace is not None and f"{namespace}_{link}" in names:
        link = f"{namespace}_{link}"
    if link not in names:
        raise PartError(place, f"{part.name} has no link {link!r}{_near(link, names)}")
    tree = KinematicTree.from_element(part.root, root)
    moving = [joint.name for joint in tree.chain(link) if joint.kind != "fixed"]
    if moving:
        raise PartError(
            place, f"{link!r} moves against the part's root {root!r}: by {', '.join(moving)}"
        )
    return tree.base_from_frame(link, {})


def _linked(joint: etree._Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else str(element.get("link", ""))


def _near(name: str, known: Mapping[str, object] | list[str]) -> str:
    near = difflib.get_close_matches(name, list(known), n=3)
    if near:
        return f"; did you mean {' or '.join(repr(each) for each in near)}?"
    return f"; there are: {', '.join(known)}"


def _numbers(values: object) -> str:
    return " ".join(repr(round(float(value), 12) + 0.0) for value in np.asarray(values))


def _rpy(pose: Transform) -> tuple[float, float, float]:
    """Roll, pitch, yaw about fixed axes; at a pitch of +-90 degrees the roll is 0."""
    r = pose.rotation
    level = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], level)
    if level < 1e-9:
        return 0.0, pitch, math.atan2(-r[0, 1], r[1, 1])
    return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])
