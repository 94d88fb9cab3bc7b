"""`momantu-bt calibrate`: the group of calibrations, which other packages fill."""

from __future__ import annotations

import typer

calibrate = typer.Typer(
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Estimate where a camera is mounted, from recorded data.",
)
