"""`momantu-bt map`: a floor plan of recorded scans, or of a world that a robot explores."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.names import counted
from momantu_bt.lazy import lazily

with lazily():
    from momantu_skills.mapping import building, exploring, extending, progress, results
    from momantu_skills.mapping import survey as surveys
    from momantu_skills.mapping.logs import reading
    from momantu_skills.mapping.three_d import log_verb

if TYPE_CHECKING:
    from collections.abc import Sequence

    from momantu_bt.geometry import Pose2D
    from momantu_skills.mapping.extending import Earlier
    from momantu_skills.mapping.logs.log import LoggedScan

RESOLUTION = 0.05
"""The usual cell of a log's map, m."""
VIEW_PORT = 8080


map_ = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@map_.callback()
def make_map(
    context: typer.Context,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="A new folder for the map.")
    ] = None,
    log: Annotated[
        Path | None, typer.Option("--log", help="A log of CARMEN, a bag of ROS, or a record.")
    ] = None,
    world: Annotated[str | None, typer.Option("--world", help="A world to explore.")] = None,
    robot: Annotated[
        str | None, typer.Option("--robot", help="The robot that explores; by default the world's.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="The seed of the world.")] = 0,
    resolution: Annotated[
        float | None,
        typer.Option(
            min=0.01,
            max=0.5,
            help="Edge of the cells of a log's map, m. Default: 0.05, or as the map of --extend.",
        ),
    ] = None,
    scan: Annotated[
        str | None, typer.Option(help="The laser's topic, in a bag or record with several.")
    ] = None,
    cloud: Annotated[
        str | None,
        typer.Option(help="The lidar's topic, in a bag with several; with --dimensions 3."),
    ] = None,
    imu: Annotated[
        str | None,
        typer.Option(help="The IMU's topic; none: do without it; with --dimensions 3."),
    ] = None,
    extend: Annotated[
        Path | None, typer.Option("--extend", metavar="DIR", help="Go on with the map of DIR.")
    ] = None,
    view: Annotated[
        bool, typer.Option("--view", help="Serve the scene to a browser; with --world.")
    ] = False,
    view_port: Annotated[int, typer.Option(help="The port of --view.")] = VIEW_PORT,
    dimensions: Annotated[
        int, typer.Option(min=2, max=3, help="3: also a cloud of points, by lidar and IMU.")
    ] = 2,
) -> ExitCode:
    """Make a floor plan of a recorded log or of a world to explore; show and compare maps.

    The folder gets map.yaml and map.pgm, as map_server reads them, map.png to look at,
    trajectory.tum with the pose of each scan, site.yaml with names, report.json, and survey.npz
    with what the map was made of: all or none. The same log, or the same world, robot and seed,
    gives the same map. A robot that explores runs the tree examples/map_a_building and knows
    nothing of the world. With --dimensions 3 the folder gets cloud.pcd, as PCL reads it, and
    overhang.yaml with what hangs over the floor: by a lidar of several rings, of the robot or in a
    bag with PointCloud2. Ctrl-C ends the work: the map of what was seen until then is saved.

    --extend goes on with a map: the robot finds itself on it near where its site says that it
    starts; a log is laid on it wherever it begins. DIR stays as it is, unless -o names it.

    Exit code 0: the map is written; 1: the exploration failed, with the map so far; 2: the log or
    the arguments are wrong, and nothing is written; 130: interrupted, with the map so far.

    Examples:
      momantu-bt map --log office.log -o maps/office
      momantu-bt map --log office.log.gz -o maps/office --resolution 0.03
      momantu-bt map --log rosbag2_2026_03_01 --scan /scan_front -o maps/hall
      momantu-bt map --log runs/3 -o maps/flat
      momantu-bt map --log hall.bag --dimensions 3 --cloud /velodyne_points -o maps/hall
      momantu-bt map --world my_rooms.yaml --seed 3 -o maps/rooms
      momantu-bt map --world my_rooms.yaml --seed 4 --extend maps/rooms -o maps/more --view
      momantu-bt map --log today.log --extend maps/office -o maps/office
      momantu-bt map show maps/rooms
      momantu-bt map compare maps/rooms maps/rooms_today -o difference.png
      momantu-bt map --world my_rooms.yaml --robot my_robot.yaml --dimensions 3 -o maps/rooms
    """
    if context.invoked_subcommand is not None:
        if any(given is not None for given in (out, log, world)):
            raise InputError(
                f"options of `map {context.invoked_subcommand}` stand behind its name; before it "
                "stand those that make a map"
            )
        return ExitCode.SUCCESS
    if (log is None) == (world is None):
        raise InputError("give either --log with a log, or --world with a world to explore")
    if out is None:
        raise InputError("give -o with a new folder for the map")
    if view and world is None:
        raise InputError("--view shows a world that a robot explores: give --world")
    _check_dimensions(dimensions, log, extend, scan, cloud or imu)
    results.check_folder(out, replace=extend is not None and out.resolve() == extend.resolve())
    earlier = None if extend is None else extending.read_earlier(extend)
    if world is not None:
        shown = view_port if view else None
        return _explore(world, robot, seed, out, earlier, shown, spatial=dimensions == 3)
    assert log is not None
    if dimensions == 3:
        about, ended = log_verb.map_clouds(log, cloud, imu, out, resolution or RESOLUTION)
        typer.echo(_summary(about, out))
        return ExitCode.INTERRUPTED if ended else ExitCode.SUCCESS
    return _of_log(log, scan, out, resolution, earlier)


def _of_log(
    log: Path, scan: str | None, out: Path, resolution: float | None, earlier: Earlier | None
) -> ExitCode:
    with progress.Laid() as laid:
        recorded = reading.read_log(log, scan, laid)
    for note in recorded.notes:
        typer.echo(f"note: {log}: {note}", err=True)
    if len(recorded.scans) < building.FEWEST:
        raise InputError(
            f"{log} holds {counted(len(recorded.scans), 'scan')} that can be used; a map needs "
            f"{building.FEWEST} at least"
        )
    survey, names = surveys.Survey(), None
    if earlier is not None:
        begun = _joined(log, recorded.scans, earlier)
        if begun is None:
            typer.echo("interrupted before the log was laid on the map: nothing is written")
            return ExitCode.INTERRUPTED
        survey = surveys.Survey.going_on(earlier.known, begun)
    cell = resolution or (RESOLUTION if earlier is None else earlier.grid.resolution)
    with progress.Scans(len(recorded.scans), survey) as told:
        built = building.build(recorded.scans, cell, told, survey)
    if earlier is not None:
        names = extending.names_on(earlier, built.survey.mapper.poses)
    building.write(out, built, names)
    typer.echo(_summary(built.report, out))
    return ExitCode.INTERRUPTED if built.interrupted else ExitCode.SUCCESS


def _check_dimensions(
    dimensions: int, log: Path | None, extend: Path | None, scan: str | None, spatial: str | None
) -> None:
    """Refuse options that do not fit together. spatial: one that is for clouds alone."""
    if dimensions == 2:
        if spatial is not None:
            raise InputError("--cloud and --imu are for maps in three dimensions: --dimensions 3")
        return
    if extend is not None:
        raise InputError(
            "--extend goes on with a map in two dimensions: leave out --dimensions 3, or leave "
            "out --extend and map the whole world anew"
        )
    if scan is not None:
        raise InputError("--scan chooses a laser; with --dimensions 3 --cloud chooses a lidar")
    if spatial is not None and log is None:
        raise InputError("--cloud and --imu name topics of a bag: give --log")


def _joined(log: Path, scans: Sequence[LoggedScan], earlier: Earlier) -> Pose2D | None:
    """Where the log begins on an earlier map; None if that was interrupted."""
    alone = surveys.Survey()
    with progress.Scans(len(scans), alone, "the log alone: ") as told:
        found = extending.joined(earlier, alone, scans, told)
    if found is None:
        return None
    at = found.start
    typer.echo(
        f"the log begins at ({at.x:z.2f}, {at.y:z.2f}), yaw {at.yaw:z.2f} rad, on the map "
        f"{earlier.folder}"
    )
    if found.ways > 1:
        typer.echo(
            f"note: it can be laid on that map in {found.ways} ways that are nearly as good; look "
            "whether the new map is right",
            err=True,
        )
    return at


def _explore(
    world: str,
    robot: str | None,
    seed: int,
    out: Path,
    earlier: Earlier | None,
    view: int | None,
    *,
    spatial: bool,
) -> ExitCode:
    if view is not None:
        typer.echo(f"view: http://127.0.0.1:{view}")
    with progress.Exploration() as told:
        explored = exploring.explore(world, robot, seed, out, told, earlier, view, spatial=spatial)
    if explored.about is None:
        raise InputError(f"nothing was mapped: {explored.why or explored.status}")
    if explored.why:
        typer.echo(f"the exploration ended early: {explored.why}", err=True)
    if explored.begun is not None:
        x, y, yaw = explored.begun.x, explored.begun.y, explored.begun.yaw
        typer.echo(f"it began at ({x:z.2f}, {y:z.2f}), yaw {yaw:z.2f} rad, on the earlier map")
    typer.echo(f"{explored.seconds:.1f} s simulated; {_summary(explored.about, out)}")
    if explored.status == "INTERRUPTED":
        return ExitCode.INTERRUPTED
    return ExitCode.SUCCESS if explored.status == "SUCCESS" else ExitCode.FAILURE


def _summary(about: dict[str, Any], out: Path) -> str:
    width, height = about["size_m"]
    points = f"{about['points']} points; " if "points" in about else ""
    return (
        f"{points}{counted(about['scans'], 'scan')} on {about['way_m']:.0f} m, "
        f"{counted(about['loops'], 'loop')}: "
        f"a map of "
        f"{width:.1f} x {height:.1f} m, {about['free_m2']:.0f} square metres of it free\n"
        f"written to {out}: look at {out / results.PICTURE}"
    )
