"""`momantu-bt perception render`: make labelled pictures of heaps of things."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Literal

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import OutputError
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt import labelled
    from momantu_worlds.labelled import own, studio

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
    meshes: Annotated[
        list[Path] | None,
        typer.Option(help="A folder of meshes of one's own, or a pattern; repeatable."),
    ] = None,
    category: Annotated[
        list[str] | None, typer.Option(help="The category of each --meshes.")
    ] = None,
    scale: Annotated[float, typer.Option(min=1e-6, help="Metres of a unit of the meshes.")] = 1.0,
    up: Annotated[str, typer.Option(help="Which axis of the meshes points up: z or y.")] = "z",
) -> ExitCode:
    """Render labelled pictures of heaps of things on the tables of worlds.

    Pictures that are there already are kept, so an interrupted command goes on where it ended.

    Exit code 0: all are there; 2: the arguments are wrong; 3: nothing on this machine renders.

    Examples:
      momantu-bt perception render -o pictures --seeds 0:8000
      momantu-bt perception render -o test --seeds 0:500 --testing --world my_flat.yaml
      momantu-bt perception render -o mine --meshes my_meshes --category spray --scale 0.001
    """
    wanted = parse_seeds(seeds)
    added = _own(meshes or [], category or [], scale, up, testing=testing)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{out} cannot be made: {error.strerror or error}") from None
    having = set(labelled.seeds_in(out))
    missing = [seed for seed in wanted if seed not in having]
    if len(missing) < len(wanted):
        typer.echo(f"{len(wanted) - len(missing)} of {len(wanted)} pictures are there", err=True)
    place, start = studio.Studio(worlds or (), testing=testing, own=added), time.monotonic()
    for count, seed in enumerate(missing, 1):
        labelled.write(out, place.picture(seed))
        if count % EVERY == 0:
            left = (time.monotonic() - start) / count * (len(missing) - count)
            typer.echo(f"{count} of {len(missing)} pictures, {left / 60:.0f} min left", err=True)
    typer.echo(f"{out}: {len(wanted)} pictures")
    return ExitCode.SUCCESS


def _own(
    meshes: list[Path], names: list[str], scale: float, up: str, *, testing: bool
) -> tuple[own.OwnCategory, ...]:
    """The categories made from folders of meshes."""
    if len(meshes) != len(names):
        raise InputError(
            f"--meshes is given {len(meshes)} times and --category {len(names)} times; give a "
            "category for each folder"
        )
    if len(set(names)) < len(names):
        raise InputError("--category names one category twice; put its meshes into one folder")
    if up not in ("z", "y"):
        raise InputError(f"--up {up!r}; expected z or y")
    axis: Literal["z", "y"] = "y" if up == "y" else "z"
    found = []
    for name, folder in zip(names, meshes, strict=True):
        made = own.own_category(name, folder, scale, axis, testing=testing)
        kept, held = len(made.training), len(made.testing)
        typer.echo(f"{name}: {kept} meshes to train, {held} to test; {made.symmetry}", err=True)
        found.append(made)
    return tuple(found)
