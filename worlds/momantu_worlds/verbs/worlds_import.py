"""`momantu-bt worlds import`: a Gazebo world or a floor plan as a world file."""

from __future__ import annotations

import json
import shlex
from itertools import groupby
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import OutputError
from momantu_bt.world import WorldError
from momantu_worlds.floor_plan.importing import import_floor_plan
from momantu_worlds.sdf.deviations import Deviation, Outcome
from momantu_worlds.sdf.importing import Import, import_world
from momantu_worlds.sdf.write.task import Task, Wanted

YAML = (".yaml", ".yml")


def import_sdf(
    file: Annotated[
        Path,
        typer.Argument(help="A Gazebo world, FILE.world or FILE.sdf; or a floor plan, MAP.yaml."),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The world file to write.")],
    models: Annotated[
        list[Path] | None,
        typer.Option(help="A folder to search for model://; can be repeated."),
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 when something was left out or changed.")
    ] = False,
    heed_up_axis: Annotated[
        bool,
        typer.Option("--heed-up-axis", help="Apply <up_axis> of COLLADA files; Gazebo does not."),
    ] = False,
    bring: Annotated[str, typer.Option(help="The thing to bring: the name of a model.")] = "",
    start: Annotated[
        str, typer.Option("--from", help="The surface on which it stands, or is put.")
    ] = "",
    goal: Annotated[str, typer.Option("--to", help="The surface to which it is brought.")] = "",
    tag: Annotated[
        str, typer.Option(help="A surface that gets an AprilTag. Default: that of --to.")
    ] = "",
    height: Annotated[
        float, typer.Option(min=0.1, max=20.0, help="Of the walls of a floor plan, m.")
    ] = 2.5,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the world file.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> ExitCode:
    """Turn a Gazebo world or a floor plan into a world file, and list the differences.

    A floor plan is a map of map_server: a YAML file beside a PGM, PNG or BMP picture. Walls stand
    where it is occupied, and the robot gets it as its map; tables and objects are yours to add.

    Models are looked for in --models, in GAZEBO_MODEL_PATH and GZ_SIM_RESOURCE_PATH, and beside
    the file; nothing is downloaded. Meshes become GLB files in a folder beside the world file.
    Exit code 2: the file is broken, and nothing was written.

    Examples:
      momantu-bt worlds import office.world --models ~/gazebo_models -o office.yaml
      momantu-bt worlds import office.world -o office.yaml --bring can --from desk --to table
      momantu-bt worlds import map.yaml -o building.yaml --height 3
      momantu-bt worlds preview office.yaml -o office.png
      momantu-bt run trees/bring_object.yaml --world office.yaml
    """
    if output.suffix.lower() not in YAML:
        raise OutputError(f"{output} ends with neither .yaml nor .yml")
    if output.exists() and file.exists() and output.samefile(file):
        raise OutputError(f"{output} is the map itself; choose another name for the world")
    if output.exists() and not force:
        raise OutputError(f"{output} is there already; --force overwrites it")
    if not output.parent.is_dir():
        raise OutputError(f"{output} cannot be written: there is no folder {output.parent}")
    try:
        if file.suffix.lower() in YAML:
            if bring or start or goal or tag:
                raise InputError("--bring, --from, --to and --tag are for Gazebo worlds")
            found = import_floor_plan(file, output, height)
        else:
            wanted = Wanted(bring, start, goal, tag)
            found = import_world(file, output, models or (), heed_up=heed_up_axis, wanted=wanted)
        count = found.write(output)
    except WorldError as error:
        raise InputError(str(error)) from None
    if as_json:
        typer.echo(json.dumps(_plain(found, output), indent=2))
    else:
        _print(found, output, count)
    listed = strict and len(found.deviations) > 0
    return ExitCode.FAILURE if listed else ExitCode.SUCCESS


def _print(found: Import, output: Path, assets: int) -> None:
    world = found.world
    loose = sum(not body.still for body in world.bodies)
    lights = "" if world.light is None else f", {len(world.light.suns + world.light.bulbs)} lights"
    typer.echo(
        f"wrote {output}: {len(world.bodies)} bodies ({loose} loose), {assets} meshes, "
        f"{len(world.site.surfaces)} surfaces{lights}"
    )
    for outcome, title in ((Outcome.DROPPED, "Left out"), (Outcome.CHANGED, "Different")):
        listed = [deviation for deviation in found.deviations if deviation.outcome is outcome]
        if listed:
            typer.echo(f"\n{title}")
        for line in _lines(listed):
            typer.echo(f"  {line}")
    if world.task.item:
        typer.echo(f"\nTo bring {world.task.item} from {world.task.start} to {world.task.on}:")
        typer.echo(f"  {_run(world.task, output)}")


def _run(task: Task, output: Path) -> str:
    """The command that does the task."""
    sizes = ", ".join(f"{key}: {value}" for key, value in (task.sizes or {}).items())
    values = [f"object={{{sizes}}}", f"from={task.start}", f"to={task.on}"]
    if task.tag is not None:
        values += [f"tag_id={task.tag.id}", f"tag_edge={1000 * task.tag.edge:.4g} mm"]
    given = " ".join(f"--set {shlex.quote(value)}" for value in values)
    return f"momantu-bt run bring_object --world {output} {given}"


def _lines(deviations: list[Deviation]) -> list[str]:
    """One line for each distinct deviation of a file, with its count."""

    def alike(deviation: Deviation) -> tuple[str, str, str]:
        return deviation.place.file, deviation.what, deviation.instead

    lines: list[tuple[Deviation, str]] = []
    for _, group in groupby(sorted(deviations, key=lambda f: (alike(f), f.place)), alike):
        first, *more = group
        often = f" ({len(more) + 1} times)" if more else ""
        line = f"{first.place}: {first.subject}: {first.what}{often}: {first.instead}"
        lines.append((first, line))
    return [line for _, line in sorted(lines, key=lambda entry: entry[0].place)]


def _plain(found: Import, output: Path) -> dict[str, object]:
    return {
        "world": str(output),
        "bodies": [body.name for body in found.world.bodies],
        "surfaces": list(found.world.site.surfaces),
        "start": [found.world.site.start.x, found.world.site.start.y, found.world.site.start.yaw],
        "robot": found.world.robot,
        "findings": [
            {
                "file": deviation.place.file,
                "line": deviation.place.line,
                "column": deviation.place.column,
                "subject": deviation.subject,
                "what": deviation.what,
                "instead": deviation.instead,
                "fate": deviation.outcome.value,
            }
            for deviation in found.deviations
        ],
    }
