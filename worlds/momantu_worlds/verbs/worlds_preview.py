"""`momantu-bt worlds preview`: draw a world before anything runs in it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import OutputError, check_writable, write_whole
from momantu_bt.lazy import lazily
from momantu_bt.robots.plugins import load_robot
from momantu_bt.world import WorldError
from momantu_worlds.worlds import load_world_file

with lazily():
    from momantu_worlds.preview import page


def preview(
    world: Annotated[str, typer.Argument(help="The world's name, or its file.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The PNG file to write.")],
    seed: Annotated[int, typer.Option(min=0, help="The episode to draw.")] = 0,
    robot: Annotated[
        str | None, typer.Option(help="A robot's name or file. Default: the world's own.")
    ] = None,
    plan: Annotated[
        bool, typer.Option("--plan", help="Only the plan; needs no simulator and no Vulkan driver.")
    ] = False,
) -> ExitCode:
    """Draw a world from above.

    The picture is a plan with names, and beneath it a view with the walls cut low.

    Exit code 0: the picture is written; 2: the world file or the arguments are wrong; 3: nothing
    on this machine renders the view (the plan alone needs no such thing: --plan).

    Examples:
      momantu-bt worlds preview my_flat.yaml -o flat.png
      momantu-bt worlds preview my_flat.yaml --seed 3 --robot my_robot/ -o flat.png
      momantu-bt worlds preview my_flat.yaml --plan -o plan.png
    """
    check_writable(out)
    if out.suffix.lower() != ".png":
        raise OutputError(f"{out} is not a .png file; the picture is a PNG")
    entry = load_world_file(world)
    try:
        entry.site()  # a file that is wrong is told before anything starts
        description = load_robot(robot or entry.default_robot)
    except WorldError as error:
        raise InputError(str(error)) from None
    write_whole(out, page.page(entry.draw(seed), description, view=not plan))
    typer.echo(f"{out}: {world}, seed {seed}")
    return ExitCode.SUCCESS
