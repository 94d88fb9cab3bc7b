"""`momantu-bt map show`: what a map holds, as text, as a picture and as JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import OutputError, check_writable, write_whole
from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily

with lazily():
    from rich.console import Console

    from momantu_skills.mapping import saved
    from momantu_skills.mapping.pictures import floor_plan, terminal

if TYPE_CHECKING:
    from momantu_skills.mapping.saved import SavedMap


def show(
    map_: Annotated[
        Path, typer.Argument(metavar="MAP", help="A map's folder, or a map_server YAML file.")
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write a picture to this PNG file.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> ExitCode:
    """Show a map: its size, areas, way and names, and a picture as wide as the terminal.

    Exit code 0: it is shown; 2: the map or the arguments are wrong.

    Examples:
      momantu-bt map show maps/office
      momantu-bt map show maps/office -o office.png --json office.json
      momantu-bt map show hall.yaml
    """
    check_picture(out)
    if output is not None:
        check_writable(output)
    found = saved.read_saved(map_)
    places = _places(found)
    overlay = terminal.Overlay(found.way, None, places)
    console = Console()
    console.print(terminal.map_text(found.grid, console.width, None, overlay))
    typer.echo("\n".join(_lines(found, places)))
    if out is not None:
        write_whole(out, floor_plan.floor_plan_png(found.grid, found.way, found.names))
        typer.echo(f"written to {out}")
    if output is not None:
        write_whole(output, json.dumps(figures(found), indent=2) + "\n")
    return ExitCode.SUCCESS


def check_picture(out: Path | None) -> None:
    """Check that a picture can be written to a path, if there is one.

    Raises:
        OutputError: it cannot, or it is no PNG.
    """
    if out is None:
        return
    check_writable(out)
    if out.suffix.lower() != ".png":
        raise OutputError(f"{out} is not a .png file; the picture is a PNG")


def figures(found: SavedMap) -> dict[str, Any]:
    """What is known of a map, as plain data: m, rad and square metres."""
    rows, columns = found.grid.cells.shape
    names = None if found.names is None else found.names.model_dump(mode="json")
    return {
        "map": str(found.file),
        "size_m": [round(edge, 3) for edge in found.grid.size],
        "cells": [columns, rows],
        "resolution_m": found.grid.resolution,
        "origin": list(found.grid.origin),
        **{f"{kind}_m2": round(area, 2) for kind, area in found.areas.items()},
        "way_m": found.report.get("way_m"),
        "scans": found.report.get("scans"),
        "sessions": found.report.get("sessions"),
        "loops": found.report.get("loops"),
        "names": names,
    }


def _places(found: SavedMap) -> dict[str, Pose2D]:
    """Where names lie, places first."""
    if found.names is None:
        return {}
    places = {name: Pose2D(*pose) for name, pose in found.names.places.items()}
    surfaces = found.names.surfaces.items()
    return places | {name: Pose2D(*surface.centre) for name, surface in surfaces}


def _lines(found: SavedMap, places: dict[str, Pose2D]) -> list[str]:
    grid, areas = found.grid, found.areas
    (width, height), (x, y) = grid.size, grid.origin
    rows, columns = grid.cells.shape
    lines = [
        f"{found.file}: {width:.1f} x {height:.1f} m, {columns} x {rows} cells of "
        f"{grid.resolution:g} m, origin ({x:.2f}, {y:.2f})",
        f"  {areas['free']:.1f} square metres free, {areas['occupied']:.1f} occupied, "
        f"{areas['unknown']:.1f} unknown",
    ]
    report = found.report
    if "way_m" in report:
        sessions = report.get("sessions", 1)
        parts = "" if sessions == 1 else f" in {sessions} sessions"
        lines.append(
            f"  way ({terminal.WAY}) of {report['way_m']:.0f} m{parts}, {report['scans']} scans, "
            f"{report['loops']} loops"
        )
    marks = dict(zip(places, terminal.MARKS, strict=False))
    surfaces = {} if found.names is None else found.names.surfaces
    for name, pose in places.items():
        what = "place"
        if name in surfaces:
            a, b = surfaces[name].size
            what = f"surface, {a:.2f} x {b:.2f} m, {surfaces[name].height:.2f} m high"
        lines.append(
            f"  {marks.get(name, ' ')} {name}: ({pose.x:.2f}, {pose.y:.2f}), yaw {pose.yaw:.2f} "
            f"rad, {what}"
        )
    return lines
