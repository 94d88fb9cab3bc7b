"""`momantu-bt map --log BAG --dimensions 3`: a map in three dimensions of a recorded log."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from momantu_bt.errors import InputError
from momantu_bt.formats.names import counted
from momantu_skills.mapping import progress, results
from momantu_skills.mapping.logs import reading
from momantu_skills.mapping.three_d import finishing, logged, raster, registration

HALF_BAND = 0.15
"""How far above and below the lidar lies what the floor plan has, m: rings are 30 cm apart at 9 m.
"""
HEIGHT = 1.5
"""Height up to which things overhang the floor, m, where no robot is told."""


def map_clouds(
    log: Path, cloud: str | None, imu: str | None, out: Path, resolution: float
) -> tuple[dict[str, Any], bool]:
    """Map a log and write the folder; the map's report, and whether it was interrupted.

    Raises:
        LogError: the log cannot be used.
        InputError: too few of its turns can be.
        OutputError: the folder cannot be written.
        RegistrationMissingError: small_gicp is not installed.
    """
    registration.check_installed()
    recorded = reading.read_clouds(log, cloud, imu)
    for note in recorded.notes:
        _note(log, note)
    with progress.Turns(recorded.count) as told:
        found = logged.surveyed(recorded, told)
    if found is None or len(found.survey.mapper.keyframes) < finishing.FEWEST:
        kept = 0 if found is None else len(found.survey.mapper.keyframes)
        raise InputError(
            f"{log} holds {counted(kept, 'turn')} from different places; a map needs "
            f"{finishing.FEWEST} at least: the lidar must have moved"
        )
    for note in (found.stood.note, recorded.left_out.note):
        if note:
            _note(log, note)
    lowest, highest = found.lidar_height - HALF_BAND, found.lidar_height + HALF_BAND
    height = highest
    if found.stood.seen:
        lowest = max(raster.LOWEST, lowest)
        highest = max(highest, lowest + 2 * HALF_BAND)
        height = max(HEIGHT, highest)
    built = finishing.built_of(found.survey, resolution, (lowest, highest), height)
    results.write_folder(
        out, built.plan, built.stamps, built.poses, built.report, None, None, built.spatial
    )
    return built.report, found.interrupted


def _note(log: Path, said: str) -> None:
    typer.echo(f"note: {log}: {said}", err=True)
