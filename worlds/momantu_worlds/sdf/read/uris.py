"""Finding the files that an SDF file names: `model://`, `file://`, relative, Fuel's addresses."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from momantu_bt.formats.places import Place
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.read.document import Element, read_document

SEARCH_PATHS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")
"""Environment variables in which versions of Gazebo look for models."""
NEWEST = (1, 11)
"""Newest version of SDF that is read."""
OLDEST = (1, 2)
"""Oldest one; what came before named poses <origin>."""
ROOTS = ("sdf", "gazebo")
"""Tags with which an SDF file begins; the second was that of 1.2."""
MOST_NAMED = 6
"""Most folders that a message lists."""


def search_folders(
    file: Path, models: Iterable[Path], environment: Mapping[str, str]
) -> tuple[Path, ...]:
    """Folders of models in the order in which they are searched.

    Those given, those of Gazebo's own variables, the file's folder, and `models` in or beside it.
    """
    folders = [*models]
    for variable in SEARCH_PATHS:
        folders += [Path(part) for part in environment.get(variable, "").split(os.pathsep) if part]
    here = _lexical(file).parent
    folders += [here, here / "models", here.parent / "models"]
    return tuple(dict.fromkeys(f for f in map(_lexical, folders) if f.is_dir()))


class MissingFile(Exception):
    """There is no file of a name; the message says where it was searched."""


@dataclass(frozen=True, slots=True)
class Library:
    """The folders in which an import may read."""

    folders: tuple[Path, ...]

    def resolve(self, uri: str, place: Place) -> Path:
        """The existing file or folder that a URI means, as written in `place`.

        Raises:
            MissingFile: there is no such file.
            SdfError: the URI is empty, or leads out of the folders.
        """
        if not uri:
            raise SdfError(place, "<uri> is empty; expected such as model://table")
        scheme, found, rest = uri.partition("://")
        if not found:
            candidates = self._relative(uri, place)
        elif scheme in ("model", "package"):
            candidates = self._of_model(unquote(rest), place)
        elif scheme == "file":
            candidates = self._relative(unquote(rest), place)
        elif scheme in ("http", "https"):
            candidates = self._of_fuel(unquote(rest), place)
        else:
            raise MissingFile(f"{scheme}:// is not an address that can be read from a disk")
        for candidate in candidates:
            if is_there(candidate):
                return candidate
        looked = ", ".join(str(f) for f in self.folders[:MOST_NAMED])
        if scheme in ("http", "https"):
            raise MissingFile(
                f"{uri!r} is on a server, and no folder of its name is in {looked}; nothing is "
                f"downloaded: fetch it yourself (`gz fuel download -u '{uri}'`), then name the "
                "folder in which it lies by --models"
            )
        raise MissingFile(f"{uri!r} is not in {looked}; name its folder by --models")

    def _relative(self, path: str, place: Place) -> Iterator[Path]:
        """Search relative to the referring file, then in every folder, also by its own name."""
        first = Path(path).parts[0] if Path(path).parts else ""
        around = [folder.parent for folder in self.folders if folder.name == first]
        for base in (_lexical(Path(place.file)).parent, *self.folders, *around):
            candidate = _lexical(base / path)
            inside = any(candidate.is_relative_to(folder) for folder in self.folders)
            if inside or candidate.is_relative_to(_lexical(Path(place.file)).parent):
                yield candidate
            elif is_there(candidate):
                raise SdfError(
                    place,
                    f"{path!r} lies outside every folder of models; name its folder by --models",
                )

    def _of_model(self, path: str, place: Place) -> Iterator[Path]:
        name, _, rest = path.strip("/").partition("/")
        if not name or ".." in Path(path).parts or Path(path).is_absolute():
            raise SdfError(
                place, f"{path!r} leads out of its folder; expected a model's name, then a path"
            )
        for folder in self.folders:
            if folder.name == name and (folder / "model.config").is_file():
                yield folder / rest
            yield folder / name / rest

    def _of_fuel(self, path: str, place: Place) -> Iterator[Path]:
        """Find a model of the Fuel server in the download cache; nothing is downloaded."""
        words = path.split("/")
        if "models" in words[:-1]:
            name, *rest = words[words.index("models") + 1 :]
            if "files" in rest:
                rest = rest[rest.index("files") + 1 :]
            elif rest and (rest[0].isdigit() or rest[0] == "tip"):
                rest = rest[1:]
            for spelled in dict.fromkeys((name, name.lower(), name.replace(" ", "_"))):
                yield from self._of_model("/".join((spelled, *rest)), place)
                yield from self._downloaded(spelled, rest)

    def _downloaded(self, name: str, rest: list[str]) -> Iterator[Path]:
        """Fuel's own cache keeps each version in a folder of its number."""
        for folder in self.folders:
            try:
                versions = [v for v in os.listdir(folder / name) if v.isdigit()]
            except OSError:
                continue
            for version in sorted(versions, key=int, reverse=True):
                yield folder.joinpath(name, version, *rest)


def model_file(folder: Path, place: Place) -> Path:
    """The SDF file of a model's folder: the newest readable one that its model.config names.

    Raises:
        MissingFile: there is no such file.
        SdfError: model.config is broken, or leads out of the folder.
    """
    config = folder / "model.config"
    if not config.is_file():
        plain = folder / "model.sdf"
        if plain.is_file():
            return plain
        raise MissingFile(f"{folder} has neither model.config nor model.sdf")
    root = read_document(config, place)
    named = sorted(
        ((_version_of(element), element) for element in root.all("sdf") if element.text),
        key=lambda entry: entry[0],
    )
    fitting = [element for version, element in named if version <= NEWEST]
    if not fitting:
        raise MissingFile(f"{config} names no SDF file of a version up to {NEWEST[0]}.{NEWEST[1]}")
    path = _lexical(folder / fitting[-1].text)
    if not path.is_relative_to(_lexical(folder)):
        raise fitting[-1].error(f"{fitting[-1].text!r} leads out of the model's folder")
    if not path.is_file():
        raise MissingFile(f"{config} names {fitting[-1].text!r}, which is not there")
    return path


def version_of(root: Element) -> tuple[int, int]:
    """The version of an SDF file.

    Raises:
        SdfError: it is not an SDF file, or of a version that is not read.
    """
    oldest, newest = (".".join(map(str, version)) for version in (OLDEST, NEWEST))
    if root.tag not in ROOTS:
        hint = " (URDF is not SDF: `gz sdf -p FILE` converts it)" if root.tag == "robot" else ""
        raise root.error(f"the file begins with <{root.tag}>; expected <sdf version='1.6'>{hint}")
    version = _version_of(root)
    if version < OLDEST or version > NEWEST:
        written = root.attributes.get("version", "")
        raise root.error(
            f"SDF version {written!r} is not read; expected {oldest} to {newest} "
            "(`gz sdf --convert FILE` writes a newer one)"
        )
    return version


def _version_of(element: Element) -> tuple[int, int]:
    major, _, minor = element.attributes.get("version", "").strip().partition(".")
    digits = major.isascii() and major.isdigit() and len(major) < 4
    minor = minor.partition(".")[0]
    if not digits or not (minor.isascii() and minor.isdigit() and len(minor) < 4):
        return (0, 0)
    return int(major), int(minor)


def is_there(path: Path) -> bool:
    """Whether a path exists; False for names that the file system rejects."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def _lexical(path: Path) -> Path:
    """Absolute, without `..`; links are not resolved, as models are often linked into a folder."""
    return Path(os.path.normpath(path.absolute()))
