"""`momantu-bt worlds new`: write a small world to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import OutputError
from momantu_worlds.verbs.template import two_rooms


def new(
    file: Annotated[Path, typer.Argument(help="The YAML file to make; it must not exist yet.")],
    size: Annotated[
        str, typer.Option(metavar="WxD", help="Of both rooms together, along x and y, m.")
    ] = "8x5",
    schema: Annotated[
        Path | None, typer.Option(help="The JSON Schema for the editor, if there is one.")
    ] = None,
) -> ExitCode:
    """Make a small world with comments, to edit by hand.

    Two rooms with a door between them, two tables, a can and a tag: the bundled tree bring_object
    runs in it as it is. Nothing is overwritten.

    Examples:
      momantu-bt worlds new my_flat.yaml
      momantu-bt worlds new hall.yaml --size 12x7
      momantu-bt run bring_object --world ./my_flat.yaml
    """
    text = two_rooms(file, size, schema)
    try:
        with file.open("x", encoding="utf-8") as made:
            made.write(text)
    except FileExistsError:
        message = f"{file} exists already; choose another name, or remove it first"
        raise OutputError(message) from None
    except OSError as error:
        raise OutputError(f"{file} cannot be written: {error.strerror}") from None
    typer.echo(
        f"{file}: `momantu-bt worlds preview {file} -o {file.stem}.png` draws it, "
        f"`momantu-bt run bring_object --world {_path(file)}` runs a job in it"
    )
    return ExitCode.SUCCESS


def _path(file: Path) -> str:
    """The file as `--world` takes it."""
    return str(file) if file.suffix in (".yaml", ".yml") else f"./{file}"
