"""`momantu-bt calibrate robot`: joints, camera and wheels at once, from views of tags."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.lazy import lazily
from momantu_bt.robots.plugins import load_robot

with lazily():
    from momantu_skills.calibration import robot_text, robot_write
    from momantu_skills.calibration.robot import estimate, rows


def robot(
    views: Annotated[Path, typer.Argument(help="A file of views, a JSON object per line.")],
    robot: Annotated[str, typer.Option(help="An installed robot's name, or a robot file.")],
    camera: Annotated[
        str | None, typer.Option(help="Which camera; not given: the robot's first one.")
    ] = None,
    on_hand: Annotated[
        list[int] | None,
        typer.Option(help="A tag that moves with the hand, by its id; not given: finds out."),
    ] = None,
    track: Annotated[
        float | None,
        typer.Option(min=0.05, help="Between the wheels, m; not given: from the URDF."),
    ] = None,
    keep: Annotated[
        list[str] | None,
        typer.Option(help="A parameter that is right already, such as 'focal length'."),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the result to a file, as JSON.")
    ] = None,
    write: Annotated[
        Path | None, typer.Option(help="Write joints and camera into this robot file.")
    ] = None,
) -> ExitCode:
    """Estimate joint zeros, the camera's mounting and lens, and the wheels, from views of tags.

    The tags' places need not be known: neither of those that stand around, nor of one on the hand.

    Exit code 0: the calibration is printed; 2: a file is wrong, or the views do not allow one.

    Examples:
      momantu-bt calibrate robot views.jsonl --robot my_robot
      momantu-bt calibrate robot views.jsonl --robot my_robot --on-hand 7 --json found.json
      momantu-bt calibrate robot views.jsonl --robot my_robot/ --write my_robot/robot.yaml
    """
    if json_file is not None:
        check_writable(json_file)
    description = load_robot(robot)
    if write is not None:
        robot_write.refuse_wrong(write, description)
    settings = estimate.Settings(
        camera, tuple(on_hand) if on_hand else None, track, tuple(keep or ())
    )
    found = estimate.calibrate(rows.read_rows(views), description, settings)
    for line in robot_text.lines(found):
        typer.echo(line)
    doubts = list(robot_text.notes(found))
    for note in doubts:
        typer.echo(f"note: {note}")
    if json_file is not None:
        write_whole(json_file, json.dumps(robot_text.plain(found, doubts), indent=2) + "\n")
        typer.echo(f"written to {json_file}")
    if write is not None:
        robot_write.write(write, found)
        typer.echo(f"written into {write}")
    return ExitCode.SUCCESS
