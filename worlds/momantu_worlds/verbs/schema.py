"""`momantu-bt worlds schema`: what an editor completes in world files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

EXIT_WRONG_INPUT = 2
DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema(
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write to this file; else print it.")
    ] = None,
) -> int:
    """Print a JSON Schema of world files.

    With it editors complete keys, show what they mean, and mark what is wrong while it is typed;
    reading the file says more, `momantu-bt worlds check` most.

    Examples:
      momantu-bt worlds schema -o world.schema.json
    """
    from momantu_worlds.scenes.sites import put

    text = json.dumps(world_schema(), indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
        return 0
    try:
        put(out, text.encode())
    except OSError as error:
        typer.echo(f"momantu-bt: {out} cannot be written: {error.strerror}", err=True)
        return EXIT_WRONG_INPUT
    typer.echo(f"schema: {out}; begin a world file with `# yaml-language-server: $schema={out}`")
    return 0


def world_schema() -> dict[str, Any]:
    """The schema, from the models that read world files."""
    from momantu_worlds.scenes.world_file import WorldFile

    made: dict[str, Any] = WorldFile.model_json_schema(mode="validation")
    return {"$schema": DIALECT, **made, "title": "momantu-bt world file"}
