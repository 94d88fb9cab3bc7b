"""Print a JSON Schema, or write it where an editor finds it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import check_writable, write_whole

Out: TypeAlias = Annotated[
    Path | None, typer.Option("--out", "-o", help="Write to this file. Default: print.")
]


def put_schema(schema: Mapping[str, Any], out: Path | None, what: str) -> ExitCode:
    """Print or write a schema, and print how a file refers to it. what: "a tree"."""
    text = json.dumps(schema, indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
        return ExitCode.SUCCESS
    check_writable(out)
    write_whole(out, text)
    typer.echo(f"schema: {out}; begin {what} with `# yaml-language-server: $schema={out}`")
    return ExitCode.SUCCESS
