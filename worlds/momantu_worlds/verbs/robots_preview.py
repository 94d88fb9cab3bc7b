"""`momantu-bt robots preview`: draw a robot in its named poses."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import OutputError, write_whole
from momantu_bt.lazy import lazily
from momantu_bt.robots.plugins import load_robot

with lazily():
    from momantu_worlds.preview import robot_sheet


def preview(
    robot: Annotated[str, typer.Argument(help="An installed robot's name, or a robot file.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="The PNG file. Default: the robot's name.")
    ] = None,
) -> ExitCode:
    """Draw a robot in its named poses, with its frames and what its camera sees.

    It stands before a table, as far off as it stands to look, on squares of half a metre. Axes are
    red (x), green (y) and blue (z).

    Exit code 0: the picture is written; 2: the robot or the file is wrong; 3: the robot cannot be
    simulated, or nothing on this machine renders.

    Examples:
      momantu-bt robots preview fetch
      momantu-bt robots preview robots/my_robot/robot.yaml -o my_robot.png
    """
    if out is not None and out.suffix.lower() != ".png":
        raise OutputError(f"{out} is not a .png file; the picture is a PNG")
    if out is not None and not out.absolute().parent.is_dir():
        raise OutputError(f"there is no folder {out.absolute().parent}")
    description = load_robot(robot)
    path = out or Path(f"{description.name}.png")
    write_whole(path, robot_sheet.robot_sheet(description))
    typer.echo(f"{path}: {description.name}, {len(description.named_poses)} poses")
    return ExitCode.SUCCESS
