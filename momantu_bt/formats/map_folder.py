"""The folder of a map: the names of its files, and which map a path on a command line means."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.errors import InputError
from momantu_bt.formats.names import valid_names

MAP, OVERHANG, NAMES = "map.yaml", "overhang.yaml", "site.yaml"
"""The files of a map's folder that others read."""
_PICTURES = (".pgm", ".png", ".bmp")
_WHAT = (
    "a map is a folder that `momantu-bt map` wrote, with its map.yaml, or a map_server YAML file"
)


def map_file(path: Path, said: str) -> Path:
    """The YAML file of the map that a person means by a folder or a file.

    said: the words with which an error begins, such as `--map maps/office`.

    Raises:
        InputError: there is no such map; the message says what there is.
    """
    if path.is_file():
        if path.suffix.lower() in _PICTURES:
            beside = path.with_suffix(".yaml")
            there = f"; did you mean {beside}?" if beside.is_file() else f"; {_WHAT}"
            raise InputError(f"{said} is the map's picture{there}")
        return path
    if path.is_dir():
        if (path / MAP).is_file():
            return path / MAP
        others = sorted(each.name for each in path.glob("*.yaml"))
        hint = f"it has {', '.join(others)}: name the file itself" if others else _WHAT
        raise InputError(f"{said}: the folder has no {MAP}; {hint}")
    raise InputError(f"{said}: there is no such folder or file; {_near(path)}{_WHAT}")


def _near(path: Path) -> str:
    """Which neighbour of a path may be meant, as the start of a sentence's rest."""
    there = path.parent
    if not there.is_dir():
        return f"{there} is not there either; "
    maps = sorted(each.name for each in there.iterdir() if (each / MAP).is_file())
    hint = valid_names(path.name, maps, "maps there") if maps else ""
    return f"{hint}; " if hint else ""
