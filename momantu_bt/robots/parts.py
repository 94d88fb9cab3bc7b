"""Find and read the URDF of each part."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.urdf import UrdfError, parse_urdf
from momantu_bt.robots.errors import PartError, RobotNotInstalled
from momantu_bt.robots.packages import Packages
from momantu_bt.robots.robot_file import PackageFile, PartSource
from momantu_bt.robots.xacro_files import expand

MOST_BYTES = 20_000_000
"""Largest URDF that is read; no robot's is longer."""
_TAIL = 3
"""Parts of a path that name a file of a package: `fetch_description/meshes/torso.dae`."""


@dataclass(frozen=True, slots=True)
class LoadedPart:
    """One part's URDF.

    path: the file that the robot file names. root: its `robot` element. files: all files that it
    was read from, by names that other machines can use. meshes: the user's folder of meshes.
    packages: those that it may name.
    """

    name: str
    source: PartSource
    path: Path
    root: etree._Element
    files: Mapping[str, Path]
    meshes: Path | None
    packages: Packages

    def where(self, line: int) -> str:
        """The place of a line, for messages; of what xacro made only the file is known."""
        return self.path.name if self.source.xacro is not None else f"{self.path.name}:{line}"


def line_of(element: etree._Element) -> int:
    """The line that an element begins in; 0 of one that was not read."""
    return getattr(element, "sourceline", None) or 0


def load_part(
    name: str,
    source: PartSource,
    folder: Path,
    meshes: Path | None,
    package_path: Sequence[Path] = (),
) -> LoadedPart:
    """Read one part.

    folder: of the robot file. meshes: the folder of meshes to use, if any. package_path: folders
    in which ROS packages are looked for first.

    Raises:
        PartError: a file is missing, or is not a URDF.
        RobotNotInstalled: it is in a Python package that is not installed.
    """
    kind = "urdf" if source.urdf is not None else "xacro"
    place: KeyPath = ("parts", name, kind)
    given = source.urdf if source.urdf is not None else source.xacro
    assert given is not None
    path = _in_package(given, place) if isinstance(given, PackageFile) else folder / given
    if not path.is_file():
        near = ", ".join(sorted(p.name for p in folder.glob("*.*") if "urdf" in p.name.lower()))
        beside = f"; URDF and xacro files there: {near}" if near else ""
        raise PartError(place, f"there is no file {path}{beside}")
    if path.stat().st_size > MOST_BYTES:
        raise PartError(place, f"{path} has more than {MOST_BYTES} bytes")
    packages = Packages(path, folder, package_path)
    if kind == "xacro":
        text, included = expand(path, source.args, packages, place)
    else:
        text, included = path.read_bytes(), ()
    files = {shown(each, folder): each for each in (path, *included)}
    return LoadedPart(name, source, path, _parsed(text, path, place), files, meshes, packages)


def _in_package(where: PackageFile, place: KeyPath) -> Path:
    """Locate a file inside an installed package without importing that package."""
    spec = importlib.util.find_spec(where.package)
    if spec is None or not spec.submodule_search_locations:
        raise RobotNotInstalled(
            f"{place[1]} needs the files of the Python package {where.package!r}, which is not "
            "installed; run `make setup`, or `pip install 'momantu-bt[all]'`"
        )
    found = Path(next(iter(spec.submodule_search_locations))) / where.file
    if not found.is_file():
        raise PartError(
            place,
            f"the Python package {where.package!r} is installed but has no {where.file}; "
            "reinstall the version that constraints.txt names",
        )
    return found


def shown(path: Path, folder: Path) -> str:
    """A file's name below the robot's folder; of a file elsewhere the end of its path."""
    path, folder = path.resolve(), folder.resolve()
    inside = path.is_relative_to(folder)
    return path.relative_to(folder).as_posix() if inside else "/".join(path.parts[-_TAIL:])


def _parsed(text: bytes, path: Path, place: KeyPath) -> etree._Element:
    try:
        root = parse_urdf(text, str(path))
    except UrdfError as error:
        raise PartError(place, str(error)) from None
    if root.tag != "robot":
        raise PartError(place, f"{path} is not a URDF: its element is <{root.tag}>, not <robot>")
    for tag in ("link", "joint"):
        for element in root.findall(tag):
            if not element.get("name"):
                raise PartError(place, f"{path}:{line_of(element)}: a <{tag}> without a name")
    if root.find("link") is None:
        raise PartError(place, f"{path} has no <link>")
    return root
