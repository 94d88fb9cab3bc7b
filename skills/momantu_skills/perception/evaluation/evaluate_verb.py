"""`momantu-bt perception evaluate`: measure a detector on rendered pictures."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt import detector as detectors
    from momantu_bt import labelled
    from momantu_skills.perception.evaluation import measure, precision

EVERY = 50
"""Pictures between two lines of progress."""


def evaluate(
    detector: Annotated[str, typer.Option(help="An installed detector.")] = "geometric",
    seeds: Annotated[str, typer.Option(help="One picture for each: 0:200 is 0 to 199.")] = "0:200",
    output: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option(help="Labelled pictures of this folder; none are rendered.")
    ] = None,
    worlds: Annotated[
        list[str] | None, typer.Option("--world", help="On the tables of this world; repeatable.")
    ] = None,
    training: Annotated[
        bool, typer.Option("--training", help="Render families of training, not of testing.")
    ] = False,
) -> ExitCode:
    """Measure how well a detector finds things, in one picture for each seed.

    The figures are average precisions in 0..1, as the NOCS benchmark has them: found with a box
    that overlaps the true one by 25, 50, 75 %, or with so many degrees and centimetres of error.

    Exit code 0: it is measured; 2: the arguments are wrong; 3: nothing on this machine renders.

    Examples:
      momantu-bt perception evaluate --seeds 0:500 --json geometric.json
      momantu-bt perception evaluate --detector my_detector --pictures pictures --seeds 0:100
    """
    wanted = parse_seeds(seeds)
    if output is not None:
        check_writable(output)
    make = detectors.DETECTORS.load(detector)
    if pictures is None:
        renderer = labelled.RENDERERS.load("tables")(worlds or (), testing=not training)
        source = renderer.picture
    else:
        source = lambda seed: labelled.read(pictures, seed)  # noqa: E731
    categories: dict[str, None] = {}
    seen, start = [], time.monotonic()
    for count, seed in enumerate(wanted, 1):
        made = source(seed)
        categories |= dict.fromkeys(made.categories)
        seen.append(measure.measured(made, make()))
        if count % EVERY == 0:
            left = (time.monotonic() - start) / count * (len(wanted) - count)
            typer.echo(f"{count} of {len(wanted)} pictures, {left / 60:.0f} min left", err=True)
    found = precision.average_precisions(seen, tuple(categories))
    things = sum(len(picture.true) for picture in seen)
    typer.echo(f"{detector}: {things} things in {len(wanted)} pictures")
    typer.echo(table(found))
    if output is not None:
        about = {"detector": detector, "seeds": seeds, "pictures": len(wanted), "things": things}
        write_whole(output, json.dumps({**about, **found}, indent=2) + "\n")
    return ExitCode.SUCCESS


def table(found: dict[str, dict[str, float]]) -> str:
    """The figures as lines of text, in percent."""
    names = list(next(iter(found.values())))
    lines = [" " * 8 + "".join(f"{name:>12}" for name in names)]
    for category, figures in found.items():
        lines.append(f"{category:8}" + "".join(f"{100 * figures[n]:12.1f}" for n in names))
    return "\n".join(lines)
