"""`momantu-bt worlds check`: report what makes a world unusable, before a run."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.findings import findings_json, findings_text
from momantu_bt.formats.seeds import SeedsError, parse_seeds
from momantu_bt.lazy import lazily
from momantu_bt.robots.plugins import load_robot
from momantu_bt.world import WorldError
from momantu_worlds.scenes.file.reader import read_world
from momantu_worlds.worlds import load_world_file

with lazily():
    from momantu_worlds.checking import fixed, run

MOST_SEEDS = 1000
"""Episodes of one check; more of them find nothing new."""


def check(
    world: Annotated[str, typer.Argument(help="The world's name, or its file.")],
    robot: Annotated[
        str | None, typer.Option(help="A robot's name or file. Default: the world's own.")
    ] = None,
    seeds: Annotated[
        str, typer.Option(help="Seeds of the episodes to check: 0:20, 3,5,7.")
    ] = "0:20",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> ExitCode:
    """Find what makes a world unusable.

    Looked for, without a simulator: overlaps, tables and places that the robot does not get to,
    narrow doors, tags that no camera can see, starts in collision, things that do not stand, goals
    that are met already or never can be.

    If no seed changes anything, one is checked. Standard error tells which seed is being checked.

    Exit code 0: nothing is wrong; 1: something is, and every finding is printed with its place,
    the seeds and a cure; 2: the world file or the arguments are wrong.

    Examples:
      momantu-bt worlds check my_flat.yaml
      momantu-bt worlds check my_flat.yaml --robot my_robot/ --seeds 0:50
      momantu-bt worlds check my_flat.yaml --json
    """
    episodes = parse_seeds(seeds)
    if len(episodes) > MOST_SEEDS:
        raise SeedsError(f"--seeds {seeds} are more than {MOST_SEEDS} seeds")
    entry = load_world_file(world)
    try:
        description = load_robot(robot or entry.default_robot)
        if len(episodes) > 1 and fixed.is_fixed(read_world(entry.path)):
            typer.echo(f"no seed changes anything in {world}: one is checked", err=True)
            episodes = episodes[:1]
        findings = run.check_world(
            entry.path, entry.draw, description, episodes, partial(_progress, episodes)
        )
    except WorldError as error:
        raise InputError(str(error)) from None
    if as_json:
        typer.echo(json.dumps(findings_json(world, findings), indent=2))
    else:
        typer.echo(findings_text(world, findings))
    return ExitCode.FAILURE if findings else ExitCode.SUCCESS


def _progress(seeds: Sequence[int], seed: int) -> None:
    """Say which seed is checked, unless it is the only one."""
    if len(seeds) > 1:
        typer.echo(f"seed {seed}, {list(seeds).index(seed) + 1} of {len(seeds)}", err=True)
