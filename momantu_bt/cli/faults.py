"""`momantu-bt faults`: what can be broken on purpose, and how."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.cli.help import help_of
from momantu_bt.errors import ExitCode

faults = typer.Typer(rich_markup_mode=None, invoke_without_command=True)

_JSON = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]


@faults.callback(help="List the faults of `run --fault`. `momantu-bt faults show NAME` shows one.")
def every(
    context: typer.Context,
    as_json: _JSON = False,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the tables of docs/faults.md.")
    ] = False,
) -> None:
    """List all faults, unless one of them is to be shown."""
    if context.invoked_subcommand is not None:
        return
    if markdown:
        from momantu_bt.faults.pages import as_parameters, as_table

        typer.echo(f"{as_table()}\n\n{as_parameters()}")
    else:
        _list(as_json)


@faults.command("list", help="List all faults.")
def list_all(as_json: _JSON = False) -> None:
    """List all faults."""
    _list(as_json)


def show_one(
    name: Annotated[str, typer.Argument(help="The fault's name, such as camera.dead.")],
    as_json: _JSON = False,
) -> ExitCode:
    """Show when a fault begins, its parameters, and how a run with it must end.

    Examples:
      momantu-bt faults show gripper.slips
    """
    from momantu_bt.faults.catalogue import KINDS
    from momantu_bt.faults.pages import as_data, as_text
    from momantu_bt.faults.spec import parse_fault

    kind = KINDS[parse_fault(name).name]
    typer.echo(json.dumps(as_data(kind), indent=2) if as_json else as_text(kind))
    return ExitCode.SUCCESS


def _list(as_json: bool) -> None:
    from momantu_bt.faults.catalogue import KINDS
    from momantu_bt.faults.pages import as_data

    if as_json:
        typer.echo(json.dumps([as_data(kind) for kind in KINDS.values()], indent=2))
        return
    width = max(map(len, KINDS))
    for name, kind in KINDS.items():
        typer.echo(f"{name:{width}}  {kind.doc}")


faults.command("show", help=help_of(show_one))(show_one)
