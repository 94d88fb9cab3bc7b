"""`momantu-bt calibrate hand-eye`: where a camera is mounted, from two files of poses."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.lazy import lazily

with lazily():
    from momantu_skills.calibration import hand_eye_text, notes, of_views, recorded
    from momantu_skills.calibration.hand_eye import readings
    from momantu_skills.calibration.trajectory import reading

if TYPE_CHECKING:
    from momantu_skills.calibration.trajectory.trajectory import Trajectory


class EyeOn(StrEnum):
    """What carries the camera."""

    HAND = "hand"
    BASE = "base"


def hand_eye(
    base_from_hand: Annotated[
        Path | None, typer.Option(help="Poses of the hand in the base's frame: CSV or TUM.")
    ] = None,
    hand_from_base: Annotated[Path | None, typer.Option(help="The same, inverted.")] = None,
    camera_from_target: Annotated[
        Path | None, typer.Option(help="Poses of the target in the camera's frame: CSV or TUM.")
    ] = None,
    target_from_camera: Annotated[Path | None, typer.Option(help="The same, inverted.")] = None,
    views: Annotated[
        Path | None, typer.Option(help="Both, from the file that the skill record_view writes.")
    ] = None,
    eye_on: Annotated[
        EyeOn, typer.Option(help="What carries the camera. On the base, the hand holds the target.")
    ] = EyeOn.HAND,
    align_time: Annotated[
        bool, typer.Option("--align-time", help="Estimate the offset between the files' clocks.")
    ] = False,
    gap: Annotated[
        float, typer.Option(min=0.0, help="Longest time between poses to interpolate, s.")
    ] = 0.5,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same result.")] = 0,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the result to a file, as JSON.")
    ] = None,
) -> ExitCode:
    """Estimate how a camera is mounted on a hand or a base, from recorded poses.

    Rows are `t, x, y, z, qx, qy, qz, qw` in s and m; a header may give another order. Wrong views
    are found and named, and have no influence.

    Exit code 0: the calibration is printed; 2: a file is wrong, or the data do not allow one.

    Examples:
      momantu-bt calibrate hand-eye --base-from-hand hand.csv --camera-from-target tag.csv
      momantu-bt calibrate hand-eye --views views.jsonl --json camera.json
      momantu-bt calibrate hand-eye --base-from-hand a.txt --target-from-camera b.txt --align-time
      momantu-bt calibrate hand-eye --base-from-hand a.csv --camera-from-target b.csv --eye-on base
    """
    if json_file is not None:
        check_writable(json_file)
    hands = base_from_hand, hand_from_base
    targets = camera_from_target, target_from_camera
    if views is None:
        hand = _one(*hands, "--base-from-hand", "--hand-from-base")
        target = _one(*targets, "--camera-from-target", "--target-from-camera")
    elif any(each is not None for each in (*hands, *targets)):
        raise InputError("--views has both poses; give it alone")
    else:
        hand, target = of_views.trajectories(views)
    settings = recorded.Settings(eye_on is EyeOn.BASE, align_time, gap, seed)
    try:
        found = recorded.calibrate(hand, target, settings)
    except recorded.MisreadError as error:
        raise InputError(_misread(error.reading, hand, target, settings)) from None
    doubts = notes.notes(found)
    for line in hand_eye_text.lines(found):
        typer.echo(line)
    for note in doubts:
        typer.echo(f"note: {note}")
    if json_file is not None:
        write_whole(json_file, json.dumps(hand_eye_text.plain(found, doubts), indent=2) + "\n")
        typer.echo(f"written to {json_file}")
    return ExitCode.SUCCESS


def _one(given: Path | None, inverted: Path | None, option: str, other: str) -> Trajectory:
    """The trajectory of one of two options, of which one must be given."""
    if (given is None) == (inverted is None):
        raise InputError(f"expected either {option} FILE or {other} FILE")
    if given is not None:
        return reading.read_trajectory(given)
    assert inverted is not None
    return reading.read_trajectory(inverted).inverse()


def _misread(
    better: readings.Reading, hand: Trajectory, target: Trajectory, settings: recorded.Settings
) -> str:
    """The sentence for files that fit far better if they are read otherwise."""
    kind = readings.Reading
    other = "hand" if settings.on_base else "base"
    says = {
        kind.HAND_INVERTED: f"{hand.name} is inverted: swap --base-from-hand and --hand-from-base, "
        f"or use --eye-on {other} if the camera is on the {other}",
        kind.TARGET_INVERTED: f"{target.name} is inverted: swap --camera-from-target and "
        f"--target-from-camera",
        kind.HAND_MILLIMETRES: f"positions in {hand.name} are in millimetres; write metres",
        kind.TARGET_MILLIMETRES: f"positions in {target.name} are in millimetres; write metres",
        kind.HAND_CENTIMETRES: f"positions in {hand.name} are in centimetres; write metres",
        kind.TARGET_CENTIMETRES: f"positions in {target.name} are in centimetres; write metres",
        kind.MIRRORED: f"one of {hand.name} and {target.name} is mirrored: is the picture or the "
        f"board mirrored, or one of the frames left-handed?",
        kind.HAND_TURNED_BACK: f"{_BACK} {hand.name} are inverted; {_BOTH}",
        kind.TARGET_TURNED_BACK: f"{_BACK} {target.name} are inverted; {_BOTH}",
        kind.HAND_W_FIRST: f"quaternions in {hand.name} begin with w; {_HEADER}",
        kind.TARGET_W_FIRST: f"quaternions in {target.name} begin with w; {_HEADER}",
        kind.BOTH_W_FIRST: f"quaternions in both files begin with w; {_HEADER}",
    }
    return f"the files do not fit together as they are, but far better if {says[better]}"


_BACK = "quaternions, not positions, in"
_BOTH = "write both of the same direction"
_HEADER = "a first line t,x,y,z,qw,qx,qy,qz says so"
