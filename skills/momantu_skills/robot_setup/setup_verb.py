"""`momantu-bt robots setup`: write a robot file from a URDF."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Annotated, Any

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import OutputError, write_whole
from momantu_bt.lazy import lazily
from momantu_bt.robots import RobotFileError, read_robot

with lazily():
    from momantu_skills.manipulation.model import arm_model
    from momantu_skills.robot_setup.check import pads
    from momantu_skills.robot_setup.find import proposal
    from momantu_skills.robot_setup.urdf import prepare
    from momantu_skills.robot_setup.write import summary, writer


FILE = "robot.yaml"


def setup(
    urdf: Annotated[Path, typer.Argument(help="A URDF or xacro file.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The robot's folder. Default: its name.")
    ] = None,
    samples: Annotated[
        int,
        typer.Option(min=1, max=1_000_000, help="Number of random postures for self-collisions."),
    ] = 10_000,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same proposal.")] = 0,
    arg: Annotated[
        list[str] | None,
        typer.Option("--arg", metavar="NAME=VALUE", help="An argument of the xacro file."),
    ] = None,
    package_path: Annotated[
        list[Path] | None,
        typer.Option("--package-path", help="A folder of ROS packages that the file names."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> ExitCode:
    """Write a robot file for a URDF: hand, arm, poses, footprint, sensors, self-collisions.

    What cannot be found out is said, on the terminal and in the file; nothing is asked.

    Exit code 0: the file is whole; 1: something is left to fill in; 2: no URDF, or a file in the
    way.

    Examples:
      momantu-bt robots setup my_robot.urdf
      momantu-bt robots setup my_robot.urdf.xacro -o robots/my_robot
      momantu-bt robots setup my_robot.urdf.xacro --arg arm=true --package-path ~/ws/src
      momantu-bt robots setup my_robot.urdf --samples 50000 --force
    """
    if output is not None:
        _check_free(output / FILE, force)
    given = prepare.Given(_arguments(arg or []), tuple(package_path or []))
    found = proposal.propose(urdf, samples=samples, seed=seed, given=given)
    folder = output or Path(found.name)
    path = folder / FILE
    _check_free(path, force)
    text, fill_in = _text(found, folder)
    write_whole(path, text, folders=True)
    wrong, notes = _read_again(path)
    found = dataclasses.replace(found, notes=(*found.notes, *notes))
    if as_json:
        typer.echo(json.dumps(_plain(found, path, fill_in, wrong), indent=2))
    else:
        _say(found, path, fill_in, wrong)
    return ExitCode.FAILURE if fill_in or wrong else ExitCode.SUCCESS


def _arguments(given: list[str]) -> dict[str, str]:
    """Arguments NAME=VALUE, or NAME:=VALUE as ROS writes it."""
    found = {}
    for each in given:
        name, equals, value = each.partition("=")
        name = name.removesuffix(":").strip()
        if not equals or not name:
            raise InputError(f"--arg {each}: expected NAME=VALUE, such as --arg arm=true")
        found[name] = value
    return found


def _check_free(path: Path, force: bool) -> None:
    """OutputError where a file is in the way and may not be written over."""
    if path.exists() and not force:
        raise OutputError(f"{path} exists; --force overwrites it, -o FOLDER writes elsewhere")


def _text(found: proposal.Proposal, folder: Path) -> tuple[str, tuple[str, ...]]:
    return writer.robot_file(found, folder), writer.missing(found)


def _read_again(path: Path) -> tuple[str, tuple[str, ...]]:
    """The reader's problems with the file, empty if it accepts it, and notes on the hand."""
    try:
        description = read_robot(path)
    except RobotFileError as error:
        return str(error), ()
    if not description.has_arm or description.end_effector is None:
        return "", ()
    return "", tuple(f.message for f in pads.check_pads(arm_model.ArmModel(description)))


def _plain(
    found: proposal.Proposal, path: Path, fill_in: tuple[str, ...], wrong: str
) -> dict[str, Any]:
    return {
        "file": str(path),
        **summary.plain(found),
        "without": list(writer.without(found)),
        "fill_in": list(fill_in),
        "reader": wrong,
    }


def _say(found: proposal.Proposal, path: Path, fill_in: tuple[str, ...], wrong: str) -> None:
    for line in summary.lines(found):
        typer.echo(line)
    for note in found.notes:
        typer.echo(f"note         {note}")
    for lack in writer.without(found):
        typer.echo(f"without      {lack}")
    for what in fill_in:
        typer.echo(f"FILL IN      {what}")
    typer.echo(f"written to {path}")
    if fill_in:
        typer.echo("The file cannot be read before that is filled in; its comments say how.")
    elif wrong:
        typer.echo(f"The file cannot be read yet:\n{wrong}")
    else:
        typer.echo(f"Now: momantu-bt robots check {path}")
        typer.echo(f"     momantu-bt robots preview {path}")
