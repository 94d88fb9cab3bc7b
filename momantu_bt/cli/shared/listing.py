"""Print the plug-ins of one kind, with a line about each."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable
from typing import Any

import typer

from momantu_bt.errors import PLUGIN_ERRORS, ExitCode, MomantuError, words_of
from momantu_bt.importing import output_aside
from momantu_bt.plugins import Group


def listing(group: Group[Any], about: Callable[[Any], str], as_json: bool) -> None:
    """Print every plug-in of an entry-point group with what `about` returns for it.

    A broken plug-in is listed with the reason.

    Raises:
        typer.Exit: a plug-in is broken; exit code 1.
    """
    rows: list[tuple[str, str]] = []
    broken: set[str] = set()
    for name in group:
        try:
            with output_aside():
                said = about(group.load(name))
            rows.append((name, said))
        except PLUGIN_ERRORS as error:  # a plug-in may raise anything; list it as the reason
            rows.append((name, f"broken: {_reason(error)}"))
            broken.add(name)
    if as_json:
        typer.echo(json.dumps(_plain(rows, broken), indent=2))
    else:
        _print(rows)
    if broken:
        raise typer.Exit(ExitCode.FAILURE)


def _print(rows: list[tuple[str, str]]) -> None:
    width = max((len(name) for name, _ in rows), default=0)
    for name, line in rows:
        typer.echo(f"{name:{width}}  {line}".rstrip())
    if not rows:
        typer.echo("none is installed", err=True)


def _reason(error: BaseException) -> str:
    """The first line of an error; a file with several mistakes has a line for each."""
    said = str(error) if isinstance(error, MomantuError) else words_of(error)
    return said.partition("\n")[0]


def _plain(rows: list[tuple[str, str]], broken: set[str]) -> list[dict[str, Any]]:
    return [{"name": name, "about": line, "ok": name not in broken} for name, line in rows]


def first_line(plugin: Any) -> str:
    """The first line of a plug-in's docstring."""
    lines = (inspect.getdoc(plugin) or "").splitlines()
    return lines[0] if lines else ""
