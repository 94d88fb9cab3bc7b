"""`momantu-bt skills new`: make a package for a new skill."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.scaffold import new_skill


def new(
    name: Annotated[str, typer.Argument(help="The skill's name, as trees write it.")],
    into: Annotated[
        Path, typer.Option(help="The folder to make the package's folder in.")
    ] = Path(),
) -> ExitCode:
    """Make a package with a skill that works, its entry point, a test that passes and a README.

    Examples:
      momantu-bt skills new turn
      momantu-bt skills new turn --into ~/robots
    """
    folder = new_skill(name, into)
    typer.echo(f"{folder}: `pip install -e {folder}`, then trees may say `{name}:`")
    return ExitCode.SUCCESS
