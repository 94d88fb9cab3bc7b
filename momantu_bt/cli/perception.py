"""`momantu-bt perception`: the group that renders labelled pictures and measures detectors."""

from __future__ import annotations

import typer

from momantu_bt.errors import ExitCode

perception = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@perception.callback(
    help="Render labelled pictures, train the learned detector, measure detectors."
)
def every(context: typer.Context) -> None:
    """Print the help, unless a command is named."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(ExitCode.WRONG_INPUT)
