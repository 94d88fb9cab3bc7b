"""Print notices on standard error: remarks that are not part of a result."""

from __future__ import annotations

import typer


def notice(message: object) -> None:
    """Print one line, with the program's name before it."""
    typer.echo(f"momantu-bt: {message}", err=True)
