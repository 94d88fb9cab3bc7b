"""`momantu-bt worlds preview`: a picture of a world, before anything is run in it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.cli.naming import robot_of, world_of
from momantu_bt.files import OutputError, check_writable, write_whole
from momantu_bt.world import PreviewableWorld, WorldError

EXIT_WRONG_INPUT, EXIT_NO_WORLD = 2, 3


def preview(
    world: Annotated[str, typer.Argument(help="The world's name, or its file.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The PNG file to write.")],
    seed: Annotated[int, typer.Option(min=0, help="The episode to draw.")] = 0,
    robot: Annotated[
        str | None, typer.Option(help="A robot's name or file; else the world's own.")
    ] = None,
    plan: Annotated[
        bool, typer.Option("--plan", help="Only the plan; needs no simulator and no Vulkan driver.")
    ] = False,
) -> int:
    """Draw a world from above.

    The picture is a plan with names, and beneath it a view with the walls cut low.

    Exit code 0: the picture is written; 2: the world file or the arguments are wrong; 3: nothing
    on this machine renders the view (the plan alone needs no such thing: --plan).

    Examples:
      momantu-bt worlds preview four_rooms -o four_rooms.png
      momantu-bt worlds preview my_flat.yaml --seed 3 --robot fetch -o flat.png
      momantu-bt worlds preview my_flat.yaml --plan -o plan.png
    """
    try:
        check_writable(out)
        if out.suffix.lower() != ".png":
            raise OutputError(f"{out} is no .png file; the picture is a PNG")
        entry = world_of(world)
        if not isinstance(entry, PreviewableWorld):
            raise WorldError(f"the world {world!r} cannot draw itself")
        entry.site()  # a file that is wrong is told before anything starts
        description = robot_of(robot or entry.default_robot)
    except (OutputError, WorldError) as error:
        return _complain(error, EXIT_WRONG_INPUT)
    try:
        write_whole(out, entry.preview(description, seed, view=not plan))
    except OutputError as error:
        return _complain(error, EXIT_WRONG_INPUT)
    except WorldError as error:
        return _complain(error, EXIT_NO_WORLD)
    typer.echo(f"{out}: {world}, seed {seed}")
    return 0


def _complain(error: Exception, code: int) -> int:
    typer.echo(f"momantu-bt: {error}", err=True)
    return code
