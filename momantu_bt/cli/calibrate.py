"""`momantu-bt calibrate`: the group of calibrations, which other packages fill."""

from __future__ import annotations

import typer

from momantu_bt.errors import ExitCode

calibrate = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@calibrate.callback(
    help="Estimate a camera's lens or mounting, or a whole robot, from recorded data."
)
def every(context: typer.Context) -> None:
    """Print the help, unless a calibration is named."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(ExitCode.WRONG_INPUT)
