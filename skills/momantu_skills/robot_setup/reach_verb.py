"""`momantu-bt robots reach`: draw where a robot's hand reaches."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.formats.units import option_in_unit
from momantu_bt.lazy import lazily
from momantu_bt.robots.plugins import load_robot

with lazily():
    import numpy as np

    from momantu_skills.robot_setup import reach as reaching
    from momantu_skills.robot_setup import reach_plot


def reach(
    robot: Annotated[str, typer.Argument(help="An installed robot's name, or a robot file.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Draw the map: a PNG.")
    ] = None,
    bottom: Annotated[
        str, typer.Option(help="The map from above begins at this height of the hand.")
    ] = "60cm",
    top: Annotated[str, typer.Option(help="It ends at this height.")] = "90cm",
    postures: Annotated[
        int, typer.Option(min=1000, max=10_000_000, help="How many random postures to try.")
    ] = 400_000,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same map.")] = 0,
) -> ExitCode:
    """Draw where a robot's hand reaches, from above and from the side, and from how many sides.

    Random postures within the joints' limits; whether the arm would touch itself is not checked.

    Exit code 0: it is printed; 2: the robot has no arm, or cannot be read.

    Examples:
      momantu-bt robots reach my_robot -o reach.png
      momantu-bt robots reach my_robot/ -o shelf.png --bottom 1m --top 1.4m
    """
    if output is not None:
        check_writable(output)
    low = option_in_unit("--bottom", bottom, "m", "60cm")
    high = option_in_unit("--top", top, "m", "60cm")
    if not low < high:
        raise InputError(f"--bottom {bottom} is not below --top {top}")
    description = load_robot(robot)
    found = reaching.reach(description, postures, seed)
    places = found.middles()
    far = np.hypot(places[:, 0], places[:, 1])
    within = (places[:, 2] > low) & (places[:, 2] < high)
    half = reaching.CELL / 2
    typer.echo(f"{description.name}: {postures} postures, cells of {reaching.CELL:g} m")
    typer.echo(
        f"highest {places[:, 2].max() + half:.1f} m, lowest {places[:, 2].min() - half:.1f} m"
    )
    typer.echo(f"farthest {far.max() + half:.1f} m from the base's middle")
    if within.any():
        typer.echo(f"between {bottom} and {top}: up to {far[within].max() + half:.1f} m")
    else:
        typer.echo(f"between {bottom} and {top} the hand is never")
    if output is not None:
        write_whole(output, reach_plot.plot(description, found, (low, high)))
        typer.echo(f"drawn in {output}")
    return ExitCode.SUCCESS
