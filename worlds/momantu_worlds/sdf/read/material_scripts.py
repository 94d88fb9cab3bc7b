"""Colours of materials by name: Gazebo's common ones, and scripts that models bring along."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_worlds.sdf.read.model import Material, Rgba
from momantu_worlds.sdf.read.uris import Library, MissingFile, is_there

COMMON: Mapping[str, tuple[float, float, float]] = {
    "black": (0.05, 0.05, 0.05),
    "blue": (0.10, 0.15, 0.80),
    "bricks": (0.58, 0.36, 0.28),
    "ceilingtiled": (0.86, 0.86, 0.83),
    "cloudysky": (0.62, 0.73, 0.85),
    "darkgray": (0.33, 0.33, 0.33),
    "darkgrey": (0.33, 0.33, 0.33),
    "darkmagentatransparent": (0.45, 0.10, 0.45),
    "darkorangetransparent": (0.75, 0.42, 0.10),
    "darkyellow": (0.65, 0.62, 0.12),
    "flatblack": (0.06, 0.06, 0.06),
    "gold": (0.80, 0.65, 0.22),
    "grass": (0.32, 0.47, 0.20),
    "gray": (0.62, 0.62, 0.62),
    "grey": (0.62, 0.62, 0.62),
    "green": (0.12, 0.62, 0.16),
    "gravel": (0.52, 0.50, 0.47),
    "indigo": (0.30, 0.14, 0.52),
    "lightwood": (0.74, 0.58, 0.39),
    "mud": (0.36, 0.27, 0.18),
    "orange": (0.90, 0.48, 0.12),
    "paintedwall": (0.80, 0.78, 0.72),
    "pavement": (0.48, 0.48, 0.49),
    "pedestrian": (0.55, 0.50, 0.47),
    "pinewood": (0.75, 0.62, 0.43),
    "pinkmarble": (0.80, 0.66, 0.64),
    "purple": (0.52, 0.14, 0.60),
    "red": (0.80, 0.10, 0.10),
    "redbright": (0.90, 0.12, 0.10),
    "residential": (0.62, 0.55, 0.48),
    "road": (0.26, 0.26, 0.27),
    "skyblue": (0.45, 0.66, 0.86),
    "turquoise": (0.16, 0.70, 0.68),
    "white": (0.94, 0.94, 0.94),
    "whiteglow": (0.98, 0.98, 0.98),
    "wood": (0.60, 0.43, 0.27),
    "woodfloor": (0.62, 0.45, 0.29),
    "woodpallet": (0.66, 0.52, 0.36),
    "yellow": (0.88, 0.80, 0.14),
    "zincyellow": (0.93, 0.87, 0.30),
}
"""Our own colours for names `Gazebo/…`, without regard to case; of pictures, about their mean."""
MOST_BYTES = 2_000_000
MOST_FILES = 200
_BLOCK = re.compile(r"^\s*material\s+(\"[^\"]+\"|\S+)", re.MULTILINE)
_DIFFUSE = re.compile(r"^\s*diffuse\s+([-+.\de\s]+)$", re.MULTILINE)
_AMBIENT = re.compile(r"^\s*ambient\s+([-+.\de\s]+)$", re.MULTILINE)
_TEXTURE = re.compile(r"^\s*texture\s+(\S+)", re.MULTILINE)


@dataclass(slots=True)
class MaterialScripts:
    """Looks materials up; every script file is read once."""

    library: Library
    _files: dict[Path, dict[str, Material]] = field(default_factory=dict)

    def find(self, name: str, uris: list[tuple[str, Place]]) -> Material | None:
        """The material of a name: from the scripts that are named with it, or a common one."""
        folders = [found for uri, place in uris for found in self._folders(uri, place)]
        for file in (file for folder in folders for file in _scripts_in(folder)):
            if file not in self._files:
                self._files[file] = _materials_in(file, folders)
            if name in self._files[file]:
                return self._files[file][name]
        prefix, _, short = name.partition("/")
        color = COMMON.get(short.lower()) if prefix == "Gazebo" else None
        return None if color is None else Material((*color, 1.0))

    def _folders(self, uri: str, place: Place) -> Iterator[Path]:
        try:
            yield self.library.resolve(uri, place)
        except MissingFile:
            return


def _scripts_in(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    return sorted(path.glob("*.material"))[:MOST_FILES]


def _materials_in(file: Path, folders: list[Path]) -> dict[str, Material]:
    """Materials of an OGRE script; of each, its first diffuse colour and its first texture."""
    try:
        if file.stat().st_size > MOST_BYTES:
            return {}
        text = file.read_text("utf-8", errors="replace")
    except OSError:
        return {}
    text = re.sub(r"//[^\n]*", "", text)
    starts = list(_BLOCK.finditer(text))
    ends = [start.start() for start in starts[1:]] + [len(text)]
    return {
        start[1].strip('"'): _material(text[start.end() : end], file, folders)
        for start, end in zip(starts, ends, strict=True)
    }


def _material(block: str, file: Path, folders: list[Path]) -> Material:
    texture = _TEXTURE.search(block)
    picture = None
    if texture is not None and ".." not in Path(texture[1]).parts:
        around = [*folders, file.parent, file.parent.parent / "textures"]
        candidates = (folder / texture[1] for folder in around)
        picture = next((path for path in candidates if is_there(path)), None)
    return Material(_color(_DIFFUSE, block) or _color(_AMBIENT, block), picture)


def _color(pattern: re.Pattern[str], block: str) -> Rgba | None:
    found = pattern.search(block)
    try:
        values = [min(max(float(word), 0.0), 1.0) for word in found[1].split()] if found else []
    except ValueError:
        return None
    return (values[0], values[1], values[2], 1.0) if len(values) >= 3 else None
