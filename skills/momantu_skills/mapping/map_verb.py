"""`momantu-bt map`: a floor plan of recorded scans."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Self

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.lazy import lazily

with lazily():
    from momantu_skills.mapping import building, results
    from momantu_skills.mapping.logs import reading

if TYPE_CHECKING:
    from momantu_skills.mapping.building import Built

STEP = 0.05
"""Share of the scans after which a line of progress is printed."""


def make_map(
    log: Annotated[Path, typer.Option("--log", help="A log of CARMEN, a bag of ROS, or a record.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="A new folder for the map.")],
    resolution: Annotated[
        float, typer.Option(min=0.01, max=0.5, help="Edge of the map's cells, m.")
    ] = 0.05,
    scan: Annotated[
        str | None, typer.Option(help="The laser's topic, in a bag or record with several.")
    ] = None,
) -> ExitCode:
    """Make a floor plan of a recorded log.

    The folder gets map.yaml and map.pgm, as map_server reads them, map.png to look at,
    trajectory.tum with the pose of each scan, and report.json. The same log gives the same map.
    Ctrl-C ends the reading: the map of what was read until then is saved.

    Exit code 0: the map is written; 2: the log or the arguments are wrong, and nothing is written;
    130: interrupted, with the map so far.

    Examples:
      momantu-bt map --log office.log -o maps/office
      momantu-bt map --log office.log.gz -o maps/office --resolution 0.03
      momantu-bt map --log rosbag2_2026_03_01 --scan /scan_front -o maps/hall
      momantu-bt map --log runs/3 -o maps/flat
    """
    results.check_folder(out)
    recorded = reading.read_log(log, scan)
    for note in recorded.notes:
        typer.echo(f"note: {log}: {note}", err=True)
    if len(recorded.scans) < building.FEWEST:
        raise InputError(
            f"{log} holds {len(recorded.scans)} scans that can be used; a map needs "
            f"{building.FEWEST} at least"
        )
    with _Progress(len(recorded.scans)) as progress:
        built = building.build(recorded.scans, resolution, progress)
    results.write_folder(out, built.plan, built.stamps, built.poses, built.report)
    typer.echo(_summary(built, out))
    return ExitCode.INTERRUPTED if built.interrupted else ExitCode.SUCCESS


class _Progress:
    """A line on standard error now and then; Ctrl-C ends the work between two scans."""

    def __init__(self, scans: int) -> None:
        self._scans, self._next = scans, STEP
        self._stopped = False

    def __enter__(self) -> Self:
        self._before = signal.signal(signal.SIGINT, self._stop)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGINT, self._before)

    def _stop(self, *_: object) -> None:
        self._stopped = True
        typer.echo("interrupted: saving the map so far", err=True)

    def __call__(self, done: int, loops: int) -> bool:
        """Say how far it is; True if the work is to end."""
        if done >= self._next * self._scans:
            typer.echo(f"{done} of {self._scans} scans, {loops} loops", err=True)
            self._next += STEP
        return self._stopped


def _summary(built: Built, out: Path) -> str:
    about = built.report
    width, height = about["size_m"]
    return (
        f"{about['scans']} scans on {about['way_m']:.0f} m, {about['loops']} loops: a map of "
        f"{width:.1f} x {height:.1f} m, {about['free_m2']:.0f} square metres of it free\n"
        f"written to {out}: look at {out / results.PICTURE}"
    )
