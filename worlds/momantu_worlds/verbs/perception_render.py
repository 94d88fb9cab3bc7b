"""`momantu-bt perception render`: make labelled pictures of heaps of things."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import OutputError
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt import labelled
    from momantu_worlds.labelled import studio

EVERY = 200
"""Pictures between two lines of progress."""


def render(
    out: Annotated[Path, typer.Option("--out", "-o", help="The folder for the pictures.")],
    seeds: Annotated[
        str, typer.Option(help="One picture for each: 0:8000 is 0 to 7999.")
    ] = "0:8000",
    worlds: Annotated[
        list[str] | None, typer.Option("--world", help="On the tables of this world; repeatable.")
    ] = None,
    testing: Annotated[
        bool, typer.Option("--testing", help="Of the families that are never trained on.")
    ] = False,
) -> ExitCode:
    """Render labelled pictures of heaps of things on the tables of worlds.

    Pictures that are there already are kept, so an interrupted command goes on where it ended.

    Exit code 0: all are there; 2: the arguments are wrong; 3: nothing on this machine renders.

    Examples:
      momantu-bt perception render -o pictures --seeds 0:8000
      momantu-bt perception render -o test --seeds 0:500 --testing --world my_flat.yaml
    """
    wanted = parse_seeds(seeds)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{out} cannot be made: {error.strerror or error}") from None
    having = set(labelled.seeds_in(out))
    missing = [seed for seed in wanted if seed not in having]
    if len(missing) < len(wanted):
        typer.echo(f"{len(wanted) - len(missing)} of {len(wanted)} pictures are there", err=True)
    place, start = studio.Studio(worlds or (), testing=testing), time.monotonic()
    for count, seed in enumerate(missing, 1):
        labelled.write(out, place.picture(seed))
        if count % EVERY == 0:
            left = (time.monotonic() - start) / count * (len(missing) - count)
            typer.echo(f"{count} of {len(missing)} pictures, {left / 60:.0f} min left", err=True)
    typer.echo(f"{out}: {len(wanted)} pictures")
    return ExitCode.SUCCESS
