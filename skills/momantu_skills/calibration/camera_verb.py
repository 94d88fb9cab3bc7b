"""`momantu-bt calibrate camera`: a camera's lens, from pictures of a board."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.formats.units import option_in_unit
from momantu_bt.lazy import lazily
from momantu_skills.calibration.models import Model

with lazily():
    from momantu_skills.calibration import camera_text, camera_write
    from momantu_skills.calibration.camera import board as boards
    from momantu_skills.calibration.camera import camera_info, coverage, lens, pictures


def camera(
    folder: Annotated[Path, typer.Argument(help="A folder with pictures of the board.")],
    board: Annotated[
        str,
        typer.Option(
            help="'chessboard 9x6' (inner corners), 'charuco 7x5' (squares) or 'aprilgrid 6x6'."
        ),
    ],
    square: Annotated[str, typer.Option(help="The edge of a square or tag, such as 25mm.")],
    marker: Annotated[
        str, typer.Option(help="The edge of a ChArUco board's marker, such as 18mm.")
    ] = "0 m",
    dictionary: Annotated[
        str, typer.Option(help="The dictionary of a ChArUco board's markers.")
    ] = "4X4_50",
    gap: Annotated[
        str, typer.Option(help="Between two tags of an AprilGrid, such as 9mm.")
    ] = "0 m",
    model: Annotated[
        Model, typer.Option(help="Of the lens: pinhole with 5 or 8 coefficients, or fisheye.")
    ] = Model.PINHOLE,
    name: Annotated[str, typer.Option(help="The camera's name in the file.")] = "camera",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Write camera_info, as ROS reads it.")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the result to a file, as JSON.")
    ] = None,
    write: Annotated[
        Path | None,
        typer.Option(help="Write the picture's size and field of view into this robot file."),
    ] = None,
    sensor: Annotated[
        str | None, typer.Option(help="Which of the robot file's cameras --write means.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw where the boards were, and the residuals: a PNG.")
    ] = None,
) -> ExitCode:
    """Estimate a camera's focal lengths, centre and distortion from pictures of a board.

    Pictures that fit far worse than the others are named and do not count.

    Exit code 0: the calibration is printed; 2: the pictures do not allow one.

    Examples:
      momantu-bt calibrate camera pictures/ --board "chessboard 9x6" --square 25mm -o camera.yaml
      momantu-bt calibrate camera pictures/ --board "charuco 7x5" --square 30mm --marker 22mm
      momantu-bt calibrate camera wide/ --board "chessboard 9x6" --square 25mm --model fisheye
      momantu-bt calibrate camera pictures/ --board "chessboard 9x6" --square 25mm --write my_robot/
    """
    for path in (output, plot, json_file):
        if path is not None:
            check_writable(path)
    if sensor is not None and write is None:
        raise InputError("--sensor names a camera of the robot file that --write gives; give both")
    written = None if write is None else camera_write.chosen(write, sensor)
    given = boards.read_board(
        board,
        option_in_unit("--square", square, "m", "25mm"),
        option_in_unit("--marker", marker, "m", "18mm"),
        dictionary,
        option_in_unit("--gap", gap, "m", "9mm"),
    )
    shown = pictures.read_pictures(folder, given)
    found = lens.fit(given, shown.seen, shown.size, model)
    for line in camera_text.lines(shown, found):
        typer.echo(line)
    doubts = list(camera_text.notes(shown, found))
    for note in doubts:
        typer.echo(f"note: {note}")
    if json_file is not None:
        data = camera_text.plain(shown, found, doubts)
        write_whole(json_file, json.dumps(data, indent=2) + "\n")
        typer.echo(f"written to {json_file}")
    if output is not None:
        write_whole(output, camera_info.camera_info(found, shown.size, name))
        typer.echo(f"written to {output}")
    if write is not None and written is not None:
        said = camera_write.write(write, written, found, shown.size)
        typer.echo(f"written into {write}: {said}")
    if plot is not None:
        write_whole(plot, coverage.plot(shown, found))
        typer.echo(f"drawn in {plot}")
    return ExitCode.SUCCESS
