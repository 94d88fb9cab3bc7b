"""`momantu-bt map compare`: lay one map on another and say where they differ."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable, write_whole
from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_skills.mapping.show_verb import check_picture

with lazily():
    import numpy as np

    from momantu_skills.mapping import saved
    from momantu_skills.mapping.comparing import agreement, align, picture, side

if TYPE_CHECKING:
    from momantu_skills.mapping.comparing.agreement import Judged, Overlaid, Thing
    from momantu_skills.mapping.comparing.align import Aligned
    from momantu_skills.mapping.comparing.side import Side

NAMED = 5
"""Most things of each map that are printed; the JSON file has all of them."""


def compare(
    a: Annotated[
        Path, typer.Argument(metavar="A", help="A map's folder, or a map_server YAML file.")
    ],
    b: Annotated[Path, typer.Argument(metavar="B", help="The map that is laid on it.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write a picture to this PNG file.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> ExitCode:
    """Lay map B on map A, wherever its origin lies and however it is turned; say what differs.

    Occupied cells agree if the other map has an occupied cell within 5 or 10 cm. Of walls that are
    thicker than two cells, the outermost cells count. What one map has and the other has free floor
    at is listed, the largest first.

    Exit code 0: the maps are compared; 1: they do not show the same place; 2: a map or the
    arguments are wrong.

    Examples:
      momantu-bt map compare maps/office maps/office_today
      momantu-bt map compare maps/office drawn.yaml -o difference.png --json difference.json
    """
    check_picture(out)
    if output is not None:
        check_writable(output)
    first, second = (_read(path) for path in (a, b))
    found = align.align(first, second)
    if found is None:
        typer.echo(f"no place was found where {b} lies on {a}: do they show the same building?")
        return ExitCode.FAILURE
    compared = Compared(first, second, found)
    typer.echo(f"A: {a}\nB: {b}\n" + "\n".join(compared.lines()))
    if out is not None:
        note = f"A: {_short(a)}    B: {_short(b)}    {compared.transform()}"
        write_whole(out, picture.comparison_png(compared.laid, note))
        typer.echo(f"written to {out}")
    if output is not None:
        figures = {"a": str(a), "b": str(b), **compared.figures()}
        write_whole(output, json.dumps(figures, indent=2) + "\n")
    return ExitCode.SUCCESS


class Compared:
    """Two maps that lie on each other."""

    def __init__(self, a: Side, b: Side, found: Aligned) -> None:
        self._sides, self._found = (a, b), found
        a_from_b = found.a_from_b
        self._told: tuple[Judged, Judged] = (
            agreement.judged(a, b, a_from_b.inverse()),
            agreement.judged(b, a, a_from_b),
        )
        self.laid: Overlaid = agreement.overlaid(a, b, a_from_b)
        self._only: tuple[list[Thing], list[Thing]] = (
            agreement.things(a, self._told[0].missing, Pose2D(0.0, 0.0)),
            agreement.things(b, self._told[1].missing, a_from_b),
        )

    def transform(self) -> str:
        """How B lies on A, in words."""
        at = self._found.a_from_b
        degrees = math.degrees(at.yaw)
        yaw = f"{at.yaw:z.4f} rad ({degrees:z.2f} deg)"
        return f"a_from_b: x {at.x:z.3f} m, y {at.y:z.3f} m, yaw {yaw}"

    def lines(self) -> list[str]:
        """All that a person is told."""
        areas = self.laid.areas
        lines = [self.transform()]
        if self._found.share < align.SURE_SHARE:
            lines.append(
                f"only {100 * self._found.share:.0f} % agree of the walls that lie where the other "
                "map knows something: look whether it is the same place"
            )
        for pose in self._found.rivals:
            lines.append(
                f"B also fits turned otherwise, nearly as well: x {pose.x:z.2f} m, y {pose.y:z.2f} "
                f"m, yaw {pose.yaw:z.2f} rad"
            )
        for name, told in zip("AB", self._told, strict=True):
            near, same = (100 * float(np.mean(each)) for each in (told.near, told.same))
            lines.append(
                f"occupied cells of {name} that agree: {near:.1f} % within 5 cm, {same:.1f} % "
                "within 10 cm"
            )
        lines.append(
            f"known to both: {areas['known_to_both_m2']:.1f} square metres; to A alone: "
            f"{areas['known_only_to_a_m2']:.1f}; to B alone: {areas['known_only_to_b_m2']:.1f}"
        )
        lines.append(
            f"occupied in A, free in B: {areas['occupied_in_a_free_in_b_m2']:.2f} square metres; "
            f"free in A, occupied in B: {areas['free_in_a_occupied_in_b_m2']:.2f}"
        )
        for name, things in zip("AB", self._only, strict=True):
            lines += _listed(name, things)
        return lines

    def figures(self) -> dict[str, Any]:
        """The same as plain data; m, rad, square metres, shares 0..1. All in A's frame."""
        at = self._found.a_from_b
        shares = {
            name: {
                "agree_5cm": round(float(np.mean(told.near)), 4),
                "agree_10cm": round(float(np.mean(told.same)), 4),
                "only_here": [
                    {"middle": _rounded(thing.middle), "size": _rounded(thing.size)}
                    for thing in things
                ],
            }
            for name, told, things in zip(("in_a", "in_b"), self._told, self._only, strict=True)
        }
        return {
            "a_from_b": _pose(at),
            "agree_where_both_know": round(self._found.share, 4),
            "rivals": [_pose(pose) for pose in self._found.rivals],
            **{name: round(area, 3) for name, area in self.laid.areas.items()},
            **shares,
        }


def _read(path: Path) -> Side:
    found = side.Side(saved.read_saved(path).grid)
    if not len(found.points):
        raise InputError(f"{path} has no occupied cell, so nothing tells how it lies on another")
    return found


def _listed(name: str, things: Sequence[Thing]) -> list[str]:
    lines = [
        f"only in {name}: {thing.size[0]:.2f} x {thing.size[1]:.2f} m around "
        f"({thing.middle[0]:z.2f}, {thing.middle[1]:z.2f})"
        for thing in things[:NAMED]
    ]
    if len(things) > NAMED:
        lines.append(f"only in {name}: {len(things) - NAMED} smaller ones")
    return lines


def _pose(pose: Pose2D) -> dict[str, float]:
    return {"x": round(pose.x, 4), "y": round(pose.y, 4), "yaw": round(pose.yaw, 5)}


def _rounded(pair: tuple[float, float]) -> list[float]:
    return [round(each, 3) for each in pair]


def _short(path: Path) -> str:
    return "/".join(path.parts[-2:])
