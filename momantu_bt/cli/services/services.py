"""`momantu-bt services`: the installed services, and what trees can read of each."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from momantu_bt.cli.services.text import as_data, as_text
from momantu_bt.cli.shared.help import help_of
from momantu_bt.cli.shared.listing import first_line, listing
from momantu_bt.errors import ExitCode
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.lazy import lazily
from momantu_bt.plugins import PluginError
from momantu_bt.tree.plugins import SERVICES

with lazily():
    from momantu_bt import scaffold, testing

services = typer.Typer(rich_markup_mode=None, invoke_without_command=True)
_JSON = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]


@services.callback(help="List the installed services. `momantu-bt services show NAME` shows one.")
def every(context: typer.Context, as_json: _JSON = False) -> None:
    """List the installed services, unless one of them is to be shown."""
    if context.invoked_subcommand is None:
        listing(SERVICES, first_line, as_json)


@services.command("list", help="List the installed services.")
def list_all(as_json: _JSON = False) -> None:
    """List the installed services."""
    listing(SERVICES, first_line, as_json)


@services.command("show", help="Show what a service publishes, and what a site can set of it.")
def show_one(
    name: Annotated[str, typer.Argument(help="The service's name, as trees read it.")],
    as_json: _JSON = False,
) -> None:
    """Show one service."""
    service = SERVICES.load(name)
    about = json.dumps(as_data(name, service), indent=2) if as_json else as_text(name, service)
    typer.echo(about)


def new(
    name: Annotated[str, typer.Argument(help="The service's name, as trees read it.")],
    into: Annotated[
        Path, typer.Option(help="The folder to make the package's folder in.")
    ] = Path(),
) -> ExitCode:
    """Make a package with a service that works, its entry points, a test that passes, a README.

    Examples:
      momantu-bt services new battery
    """
    folder = scaffold.new_service(name, into)
    typer.echo(f"{folder}: `pip install -e {folder}`, then trees may read `$@{name}.charge`")
    return ExitCode.SUCCESS


def promises(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of services. Default: all.")
    ] = None,
    seed: Annotated[int, typer.Option(help="The seed of the runs.")] = 0,
    as_json: _JSON = False,
) -> ExitCode:
    """Test services against the rules for all services, in a scripted room.

    Examples:
      momantu-bt services test
      momantu-bt services test battery
    """
    told: dict[str, list[Problem]] = {}
    for name in names or SERVICES:
        try:
            told[name] = testing.check_service(SERVICES.load(name), name=name, seed=seed)
        except PluginError as error:
            if name not in SERVICES:
                raise
            told[name] = [Problem("broken", str(error))]
        if not as_json:
            typer.echo(f"{'WRONG' if _wrong(told[name]) else 'ok   '} {name}")
            for finding in told[name]:
                typer.echo(f"      {finding}")
    passed = not any(map(_wrong, told.values()))
    if as_json:
        shown = {name: [finding.as_dict() for finding in found] for name, found in told.items()}
        typer.echo(json.dumps({"ok": passed, "services": shown}, indent=2))
    return ExitCode.SUCCESS if passed else ExitCode.FAILURE


def _wrong(found: list[Problem]) -> bool:
    return any(finding.severity is not Severity.HINT for finding in found)


services.command("new", help=help_of(new))(new)
services.command("test", help=help_of(promises))(promises)
