"""`momantu-bt worlds copy`: a world's file, and all files that it names, to edit."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import OutputError, write_whole
from momantu_worlds.worlds import load_world_file

_NAME = re.compile(r"^name:\s*\S+", re.MULTILINE)
_WORD = re.compile(r"[^a-z0-9_]+")


def copy(
    world: Annotated[str, typer.Argument(help="The world's name, or its file.")],
    file: Annotated[Path, typer.Argument(help="The YAML file to make; it must not exist yet.")],
) -> ExitCode:
    """Copy a world's file to edit it: with its comments, and with the files that it names.

    Nothing is overwritten. The copy gets the name of its file.

    Examples:
      momantu-bt worlds copy four_rooms my_rooms.yaml
      momantu-bt run bring_object --world ./my_rooms.yaml
    """
    if file.suffix.lower() not in (".yaml", ".yml"):
        raise OutputError(f"{file} ends with neither .yaml nor .yml")
    entry = load_world_file(world)
    source, *others = entry.files()
    targets = {each: _beside(each, source, file) for each in others}
    for target in (file, *targets.values()):
        if target.exists():
            raise OutputError(f"{target} is there already; choose another name, or remove it first")
    name = _WORD.sub("_", file.stem.lower()).strip("_") or "world"
    for each, target in targets.items():
        write_whole(target, each.read_bytes(), folders=True)
    text = source.read_text(encoding="utf-8")
    write_whole(file, _NAME.sub(f"name: {name}", text, count=1), folders=True)
    more = f" and {len(targets)} files beside it" if targets else ""
    typer.echo(f"wrote {file}{more}; `momantu-bt worlds check {file}` says what is wrong with it")
    return ExitCode.SUCCESS


def _beside(each: Path, source: Path, file: Path) -> Path:
    """Where a file that the world names belongs, relative to the copy as to the original."""
    try:
        return file.parent / each.resolve().relative_to(source.resolve().parent)
    except ValueError:
        raise InputError(
            f"{source} names {each}, which is not in its folder; copy the folder that has both"
        ) from None
