"""`momantu-bt skills`: the installed skills, and how to use each one."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.cli.shared.help import help_of
from momantu_bt.cli.shared.listing import first_line, listing
from momantu_bt.cli.skills.new import new
from momantu_bt.cli.skills.pages import pages
from momantu_bt.cli.skills.palette import print_palette
from momantu_bt.cli.skills.schema import schema
from momantu_bt.cli.skills.stub import stubs
from momantu_bt.cli.skills.test import promises
from momantu_bt.tree.catalogue import SPELLED
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.show.node_page import node_data, node_text
from momantu_bt.tree.show.skill_page import as_data, as_text

skills = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@skills.callback(help="List the installed skills. `momantu-bt skills show NAME` shows one.")
def every(
    context: typer.Context,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
    xml_model: Annotated[
        bool, typer.Option("--xml-model", help="Print them as XML, for Groot2's palette.")
    ] = False,
) -> None:
    """List the installed skills, unless one of them is to be shown."""
    if context.invoked_subcommand is not None:
        return
    if xml_model:
        print_palette()
    else:
        listing(SKILLS, first_line, as_json)


@skills.command("list", help="List the installed skills.")
def list_all(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """List the installed skills."""
    listing(SKILLS, first_line, as_json)


@skills.command("show", help="Show a skill's ports, what it uses, how it can fail, and examples.")
def show_one(
    name: Annotated[str, typer.Argument(help="The name of a skill or of a node, as in trees.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """Show one skill, or a node of the language."""
    if name in SPELLED and name not in SKILLS:
        spec = SPELLED[name]
        typer.echo(json.dumps(node_data(spec), indent=2) if as_json else node_text(spec))
        return
    skill = SKILLS.load(name)
    if as_json:
        typer.echo(json.dumps(as_data(name, skill), indent=2))
        return
    typer.echo(as_text(name, skill))


skills.command("new", help=help_of(new))(new)
skills.command("pages", help=help_of(pages))(pages)
skills.command("schema", help=help_of(schema))(schema)
skills.command("stub", help=help_of(stubs))(stubs)
skills.command("test", help=help_of(promises))(promises)
