"""`momantu-bt map`: a floor plan of recorded scans, or of a world that a robot explores."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.lazy import lazily

with lazily():
    from momantu_skills.mapping import building, exploring, results
    from momantu_skills.mapping.logs import reading

if TYPE_CHECKING:
    from momantu_skills.mapping.own import Mapping

EVERY = 5.0
"""Simulated time after which a line of progress is printed, s."""
STEP = 0.05
"""Share of the scans after which a line of progress is printed."""


def make_map(
    out: Annotated[Path, typer.Option("-o", "--out", help="A new folder for the map.")],
    log: Annotated[
        Path | None, typer.Option("--log", help="A log of CARMEN, a bag of ROS, or a record.")
    ] = None,
    world: Annotated[str | None, typer.Option("--world", help="A world to explore.")] = None,
    robot: Annotated[
        str | None, typer.Option("--robot", help="The robot that explores; by default the world's.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="The seed of the world.")] = 0,
    resolution: Annotated[
        float, typer.Option(min=0.01, max=0.5, help="Edge of the map's cells, m; of a log.")
    ] = 0.05,
    scan: Annotated[
        str | None, typer.Option(help="The laser's topic, in a bag or record with several.")
    ] = None,
    dimensions: Annotated[
        int, typer.Option(min=2, max=3, help="3: also a cloud of points, by lidar and IMU.")
    ] = 2,
) -> ExitCode:
    """Make a floor plan: of a recorded log, or of a world that a robot explores.

    The folder gets map.yaml and map.pgm, as map_server reads them, map.png to look at,
    trajectory.tum with the pose of each scan, site.yaml with names, and report.json: all or none.
    The same log, or the same world, robot and seed, gives the same map. A robot that explores runs
    the tree examples/map_a_building and knows nothing of the world. With --dimensions 3 the folder
    gets cloud.pcd, as PCL reads it, and overhang.yaml with what hangs over the floor too. Ctrl-C
    ends the work: the map of what was seen until then is saved.

    Exit code 0: the map is written; 1: the exploration failed, with the map so far; 2: the log or
    the arguments are wrong, and nothing is written; 130: interrupted, with the map so far.

    Examples:
      momantu-bt map --log office.log -o maps/office
      momantu-bt map --log office.log.gz -o maps/office --resolution 0.03
      momantu-bt map --log rosbag2_2026_03_01 --scan /scan_front -o maps/hall
      momantu-bt map --log runs/3 -o maps/flat
      momantu-bt map --world my_rooms.yaml --seed 3 -o maps/rooms
      momantu-bt map --world four_rooms --robot kinova_jackal --dimensions 3 -o maps/rooms
    """
    if (log is None) == (world is None):
        raise InputError("give either --log with a log, or --world with a world to explore")
    if log is not None and dimensions == 3:
        raise InputError(
            "logs are mapped in two dimensions: leave out --dimensions 3, or let a robot with a "
            "lidar of several rings and an IMU explore a --world"
        )
    results.check_folder(out)
    if world is not None:
        return _explore(world, robot, seed, out, spatial=dimensions == 3)
    assert log is not None
    return _of_log(log, scan, out, resolution)


def _of_log(log: Path, scan: str | None, out: Path, resolution: float) -> ExitCode:
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
    typer.echo(_summary(built.report, out))
    return ExitCode.INTERRUPTED if built.interrupted else ExitCode.SUCCESS


def _explore(world: str, robot: str | None, seed: int, out: Path, *, spatial: bool) -> ExitCode:
    explored = exploring.explore(world, robot, seed, out, _Clock(), spatial=spatial)
    if explored.about is None:
        raise InputError(f"nothing was mapped: {explored.why or explored.status}")
    if explored.why:
        typer.echo(f"the exploration ended early: {explored.why}", err=True)
    typer.echo(f"{explored.seconds:.1f} s simulated; {_summary(explored.about, out)}")
    if explored.status == "INTERRUPTED":
        return ExitCode.INTERRUPTED
    return ExitCode.SUCCESS if explored.status == "SUCCESS" else ExitCode.FAILURE


class _Clock:
    """A line on standard error every few seconds of the world's clock."""

    def __init__(self) -> None:
        self._next = 0.0

    def __call__(self, now: float, mapping: Mapping) -> None:
        """Say what is known by now."""
        if now >= self._next:
            self._next = now + EVERY
            known = f"{mapping.known:.1f} square metres known, {mapping.loops} loops"
            typer.echo(f"{now:7.1f} s  {known}", err=True)


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


def _summary(about: dict[str, Any], out: Path) -> str:
    width, height = about["size_m"]
    points = f"{about['points']} points; " if "points" in about else ""
    return (
        f"{points}{about['scans']} scans on {about['way_m']:.0f} m, {about['loops']} loops: "
        f"a map of "
        f"{width:.1f} x {height:.1f} m, {about['free_m2']:.0f} square metres of it free\n"
        f"written to {out}: look at {out / results.PICTURE}"
    )
