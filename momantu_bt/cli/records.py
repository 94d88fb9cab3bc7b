"""A record that a person names on the command line."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from momantu_bt.record.recording import Recording

EXIT_WRONG_ARGUMENTS = 2


def complain(message: object) -> None:
    """Say it on standard error."""
    typer.echo(f"momantu-bt: {message}", err=True)


def open_record(folder: Path) -> Recording:
    """The record in a folder; says so when it was cut off.

    Raises:
        typer.Exit: there is none that can be read, which has been said.
    """
    from momantu_bt.record.reader import RecordError, read_record

    try:
        recording = read_record(folder)
    except RecordError as error:
        complain(error)
        raise typer.Exit(EXIT_WRONG_ARGUMENTS) from None
    if not recording.ticks or not recording.nodes:
        complain(f"{folder}: the record ends before the first tick")
        raise typer.Exit(EXIT_WRONG_ARGUMENTS)
    if not recording.complete:
        last = recording.ticks[-1].now
        complain(f"{folder}: the record was cut off after {last:.2f} s; it is read up to there")
    return recording
