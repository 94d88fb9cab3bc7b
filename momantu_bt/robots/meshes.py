"""Find the meshes of a part, and replace them with a user's own."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from momantu_bt.robots.packages import SCHEME, Packages
from momantu_bt.robots.parts import LoadedPart, line_of

MESHES = "MOMANTU_BT_MESHES"
"""Environment variable: a folder with `<robot>/<part>/<link>.…`, used instead of a part's own."""
PLACES = 3
"""Most places that the message about a missing mesh names."""
ENDINGS = (".glb", ".dae", ".obj", ".stl")
"""Suffixes of mesh files, also in upper case; the first one found is used."""


def users_folder(robot: str, part: str, given: str | None, folder: Path) -> Path | None:
    """The folder with a user's meshes for a part: of the environment, or of the robot file."""
    root = os.environ.get(MESHES)
    if root and (Path(root) / robot / part).is_dir():
        return (Path(root) / robot / part).resolve()
    return None if given is None else (folder / given).resolve()


def replace_meshes(part: LoadedPart) -> Iterator[str]:
    """Put the user's meshes in place; yields what is wrong. Before names are changed."""
    folder = part.meshes
    if folder is None:
        return
    if not folder.is_dir():
        yield f"there is no folder {folder}"
        return
    found = False
    for link in part.root.findall("link"):
        name = str(link.get("name"))
        for tag, place in (("visual", folder), ("collision", folder / "collision")):
            mesh = _mesh_of(place, name)
            if mesh is not None:
                found = True
                _give(link, tag, mesh)
    if not found:
        links = ", ".join(str(link.get("name")) for link in part.root.findall("link"))
        yield (
            f"no mesh in {folder} is called like a link ({', '.join(ENDINGS)}); "
            f"links of {part.name}: {links}"
        )


def _mesh_of(folder: Path, link: str) -> Path | None:
    for ending in ENDINGS:
        for path in (folder / f"{link}{ending}", folder / f"{link}{ending.upper()}"):
            if path.is_file():
                return path
    return None


def _give(link: etree._Element, tag: str, mesh: Path) -> None:
    """One mesh in the link's own frame instead of all that the link has of this kind."""
    for element in link.findall(tag):
        link.remove(element)
    geometry = etree.SubElement(etree.SubElement(link, tag), "geometry")
    etree.SubElement(geometry, "mesh", filename=str(mesh))


@dataclass(frozen=True, slots=True)
class Located:
    """found: mesh files by what a URDF calls them. missing: sentences about the others."""

    found: Mapping[str, Path]
    missing: tuple[str, ...]


def locate_meshes(part: LoadedPart) -> Located:
    """Look up every mesh of a part. The meshes of one missing package are one sentence."""
    found: dict[str, Path] = {}
    missing: list[str] = []
    lost: dict[str, dict[str, str]] = {}
    for mesh in part.root.findall("link/*/geometry/mesh"):
        name = str(mesh.get("filename", ""))
        path = part.packages.mesh(name)
        where = part.where(line_of(mesh))
        if path is not None:
            found[name] = path.resolve()
        elif package := _lost_package(name, part.packages):
            lost.setdefault(package, {}).setdefault(name, where)
        else:
            missing.append(f"{where}: the mesh {name!r} is missing; {_looked(name, part.packages)}")
    every = (_lost(package, names, part.packages) for package, names in lost.items())
    return Located(found, (*missing, *every))


def _lost(package: str, places: Mapping[str, str], packages: Packages) -> str:
    """A sentence about a missing package. places: where each of its meshes is named."""
    first, *others = places
    which = f"the mesh {first!r} is missing"
    if others:
        which = f"{len(places)} meshes are missing, the first {first!r}"
    return f"{places[first]}: {which}; there is no package {package!r}: {packages.searched()}"


def _lost_package(name: str, packages: Packages) -> str:
    """The package that a mesh's address names, if it cannot be found; else nothing."""
    package = name.removeprefix(SCHEME).partition("/")[0]
    return package if name.startswith(SCHEME) and packages.find(package) is None else ""


def write_paths(part: LoadedPart, found: Mapping[str, Path]) -> None:
    """Name every mesh and every texture by its absolute path.

    A texture that is nowhere is left out: its link keeps its colour.
    """
    for mesh in part.root.findall("link/*/geometry/mesh"):
        mesh.set("filename", str(found[str(mesh.get("filename", ""))]))
    for texture in textures(part):
        path = part.packages.file(str(texture.get("filename")))
        above = texture.getparent()
        if path is None and above is not None:
            above.remove(texture)
        elif path is not None:
            texture.set("filename", str(path.resolve()))


def textures(part: LoadedPart) -> list[etree._Element]:
    """The elements that name a picture."""
    return [each for each in part.root.iter("texture") if each.get("filename")]


def _looked(name: str, packages: Packages) -> str:
    """Where a mesh was looked for."""
    looked = list(dict.fromkeys(packages.mesh_candidates(name)))[:PLACES]
    return f"looked for {', '.join(str(each) for each in looked)}"
