"""Join the parts of a robot into one URDF; a single part's own URDF is used unchanged."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from momantu_bt.formats.cache import cache_subfolder
from momantu_bt.formats.files import write_whole
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.problems import errors
from momantu_bt.robot_simulation import BaseJoints
from momantu_bt.robots.errors import PartError
from momantu_bt.robots.inertia import inertia_problems, replace_inertial
from momantu_bt.robots.joining import KEPT, VIRTUAL_JOINTS, Joining
from momantu_bt.robots.limits import complete_limits
from momantu_bt.robots.meshes import (
    locate_meshes,
    replace_meshes,
    textures,
    users_folder,
    write_paths,
)
from momantu_bt.robots.parts import LoadedPart, load_part, shown
from momantu_bt.robots.robot_file import RobotFile
from momantu_bt.robots.structure import root_link, wrong_structure

_DIGITS = 16
"""Length of the hash in the name of an assembled URDF in the cache."""


@dataclass(frozen=True, slots=True)
class Assembled:
    """One URDF of a whole robot.

    root: its `robot` element. path: the file. base_joints: virtual joints of the base, the URDF's
    own or added ones; None: no drive. files: the files that it was made from.
    """

    root: etree._Element
    path: Path
    mesh_directories: tuple[Path, ...]
    files: Mapping[str, Path]
    base_joints: BaseJoints | None


def assemble(robot: RobotFile, folder: Path) -> Assembled:
    """Join a robot's parts. folder: of the robot file.

    Raises:
        ExceptionGroup[PartError]: everything that is wrong with the parts.
        RobotNotInstalled: a part is in a Python package that is not installed.
    """
    parts = load_parts(robot, folder)
    _raise([error for part in parts for error in _give_inertials(part)])
    _raise([error for part in parts for error in _unfit(part)])
    drive = robot.base.drive
    joints = None if drive is None else drive.joints or VIRTUAL_JOINTS
    files = {name: path for part in parts for name, path in part.files.items()}
    meshes = _meshes(parts, folder)
    files |= {shown(path, folder): path for found in meshes for path in found.values()}
    own, limits = parts[0], robot.joint_limits
    if _is_whole(robot, parts) and not complete_limits(own.root.findall("joint"), limits):
        return Assembled(own.root, own.path, (own.path.parent,), files, joints)
    for part, found in zip(parts, meshes, strict=True):
        write_paths(part, found)
        if part.source.namespace is not None:
            _add_namespace(part.root, part.source.namespace)
    joining = Joining(robot, parts)
    _raise(list(joining.join()))
    complete_limits(joining.root.findall("joint"), limits)
    etree.cleanup_namespaces(joining.root)
    etree.indent(joining.root)
    path = keep_urdf(robot.name, etree.tostring(joining.root, encoding="utf-8"))
    return Assembled(joining.root, path, (), files, joints)


def load_parts(robot: RobotFile, folder: Path) -> list[LoadedPart]:
    """Every part's URDF, as its own file has it; raises as `assemble`."""
    parts, troubles = [], []
    package_path = [folder / each for each in robot.packages]
    for name, source in robot.parts.items():
        meshes = users_folder(robot.name, name, source.meshes, folder)
        try:
            parts.append(load_part(name, source, folder, meshes, package_path))
        except PartError as error:
            troubles.append(error)
    _raise(troubles)
    return parts


def _give_inertials(part: LoadedPart) -> Iterator[PartError]:
    """Put the inertials of the robot file in place; yields what is wrong."""
    links = {str(link.get("name")): link for link in part.root.findall("link")}
    for name, inertial in part.source.inertials.items():
        if name in links:
            replace_inertial(links[name], inertial)
        else:
            place: KeyPath = ("parts", part.name, "inertials", name)
            yield PartError(
                place, f"there is no link {name!r}; {valid_names(name, links, 'links')}"
            )


def _is_whole(robot: RobotFile, parts: list[LoadedPart]) -> bool:
    """Whether the first part's file is the whole robot, with the limits that it has."""
    own, *others = parts
    drive = robot.base.drive
    source = own.source
    changed = source.xacro or source.namespace or own.meshes or source.inertials or textures(own)
    unread = any(element.tag not in KEPT for element in own.root)
    added = others or robot.mounts or robot.frames or (drive is not None and drive.joints is None)
    return not (changed or unread or added)


def _unfit(part: LoadedPart) -> Iterator[PartError]:
    """The problems of a single part."""
    wrong = list(wrong_structure(part))
    if wrong:
        yield from (PartError(("parts", part.name), message) for message in wrong)
        return
    try:
        root_link(part)
    except PartError as error:
        yield error
    for problem in errors(inertia_problems(part.root)):
        message = f"{part.where(problem.place.line)}: {problem.message}; {problem.hint}"
        yield PartError(("parts", part.name), message)


def _meshes(parts: list[LoadedPart], folder: Path) -> list[Mapping[str, Path]]:
    """The mesh files of each part, the user's in place of its own."""
    troubles, found = [], []
    for part in parts:
        place: KeyPath = ("parts", part.name)
        troubles += [PartError((*place, "meshes"), said) for said in replace_meshes(part)]
        located = locate_meshes(part)
        troubles += [PartError(place, said) for said in located.missing]
        found.append(located.found)
    _raise(troubles)
    return found


def _raise(troubles: list[PartError]) -> None:
    if troubles:
        raise ExceptionGroup("the robot cannot be assembled", troubles)


def keep_urdf(name: str, text: bytes) -> Path:
    """Write a URDF whole or not at all, under a name that its text decides; its path.

    Raises:
        OSError: neither the user's cache nor the folder of temporary files can be written.
    """
    path = cache_subfolder("robots") / f"{name}-{hashlib.sha256(text).hexdigest()[:_DIGITS]}.urdf"
    if not path.is_file() or path.read_bytes() != text:
        write_whole(path, text)
    return path


def _add_namespace(root: etree._Element, namespace: str) -> None:
    """Rename every link, joint and material of a URDF in place."""
    for element, attribute in _names(root):
        element.set(attribute, f"{namespace}_{element.get(attribute)}")


def _names(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    """Every place where a URDF defines or uses a name: (element, attribute)."""
    for tag in ("link", "joint", "material"):
        for element in root.findall(tag):
            yield element, "name"
    for joint in root.findall("joint"):
        for tag, attribute in (("parent", "link"), ("child", "link"), ("mimic", "joint")):
            for element in joint.findall(tag):
                yield element, attribute
    for material in root.findall("link/visual/material"):
        if material.get("name"):
            yield material, "name"
