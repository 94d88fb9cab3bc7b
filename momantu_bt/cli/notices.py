"""What is said on standard error: why a verb refused, and remarks that a result does not hold."""

from __future__ import annotations

import typer


def notice(message: object) -> None:
    """Print one line, with the program's name before it."""
    typer.echo(f"momantu-bt: {message}", err=True)
