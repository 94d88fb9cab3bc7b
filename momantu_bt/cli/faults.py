"""`momantu-bt faults`: the kinds of faults, and how to write them."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.bench.reports.table import columns
from momantu_bt.cli.shared.help import help_of
from momantu_bt.cli.shared.schema_file import Out, put_schema
from momantu_bt.errors import ExitCode
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.pages import as_data, as_parameters, as_table, as_text, as_words
from momantu_bt.faults.spec import parse_fault
from momantu_bt.faults.tree_file import faults_schema
from momantu_bt.faults.tree_page import HEAD, tree_rows
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry

faults = typer.Typer(rich_markup_mode=None, invoke_without_command=True)

_JSON = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]
_TREE = Annotated[
    str | None,
    typer.Option(
        metavar="TREE", help="Print when each begins in this tree, and how the run must end."
    ),
]


@faults.callback(help="List the faults of `run --fault`. `momantu-bt faults show NAME` shows one.")
def every(
    context: typer.Context,
    as_json: _JSON = False,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the tables of docs/faults.md.")
    ] = False,
    tree: _TREE = None,
) -> None:
    """List all faults, unless one of them is to be shown."""
    if context.invoked_subcommand is not None:
        return
    if markdown:
        typer.echo(f"{as_table()}\n\n{as_words()}\n\n{as_parameters()}")
    else:
        _list(as_json, tree)


@faults.command("list", help="List all faults.")
def list_all(as_json: _JSON = False, tree: _TREE = None) -> None:
    """List all faults."""
    _list(as_json, tree)


def show_one(
    name: Annotated[str, typer.Argument(help="The fault's name, such as camera.dead.")],
    as_json: _JSON = False,
) -> ExitCode:
    """Show when a fault begins, its parameters, and how a run with it must end.

    Examples:
      momantu-bt faults show gripper.slips
    """
    kind = kinds()[parse_fault(name).name]
    typer.echo(json.dumps(as_data(kind), indent=2) if as_json else as_text(kind))
    return ExitCode.SUCCESS


def schema(out: Out = None) -> ExitCode:
    """Print a JSON Schema of files of faults, such as my_tree.faults.yaml.

    With it editors complete keys and names of faults; `momantu-bt check` says more.

    Examples:
      momantu-bt faults schema -o faults.schema.json
    """
    return put_schema(faults_schema(), out, "a file of faults")


def _list(as_json: bool, tree: str | None) -> None:
    if tree is not None:
        _list_in(tree, as_json)
    elif as_json:
        typer.echo(json.dumps([as_data(kind) for kind in kinds().values()], indent=2))
    else:
        width = max(map(len, kinds()))
        for name, kind in kinds().items():
            typer.echo(f"{name:{width}}  {kind.doc}")


def _list_in(tree: str, as_json: bool) -> None:
    registry = Registry.installed()
    rows = tree_rows(load(tree, registry).document, registry)
    if as_json:
        typer.echo(json.dumps([row.as_dict() for row in rows], indent=2))
    else:
        typer.echo("\n".join(columns([HEAD, *(row.cells() for row in rows)], indent="")))


faults.command("show", help=help_of(show_one))(show_one)
faults.command("schema", help=help_of(schema))(schema)
