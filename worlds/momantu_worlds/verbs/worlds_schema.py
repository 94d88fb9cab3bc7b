"""`momantu-bt worlds schema`: a JSON Schema of world files, for editors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from momantu_bt.descriptions.schema import editor_schema
from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import write_whole
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.verbs.schema_descriptions import description_of


def schema(
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write to this file. Default: print.")
    ] = None,
) -> ExitCode:
    """Print a JSON Schema of world files.

    With it editors complete keys, show what they mean, and mark what is wrong while it is typed;
    reading the file says more, `momantu-bt worlds check` most.

    Examples:
      momantu-bt worlds schema -o world.schema.json
    """
    text = json.dumps(world_schema(), indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
        return ExitCode.SUCCESS
    write_whole(out, text)
    typer.echo(f"schema: {out}; begin a world file with `# yaml-language-server: $schema={out}`")
    return ExitCode.SUCCESS


def world_schema() -> dict[str, Any]:
    """The schema, from the models that read world files."""
    made = WorldFile.model_json_schema(mode="validation")
    for part, schema in {"WorldFile": made, **made["$defs"]}.items():
        for key, inner in schema.get("properties", {}).items():
            description = description_of(part, key)
            if description is not None:
                inner["description"] = description
    return editor_schema(made, "momantu-bt world file")
