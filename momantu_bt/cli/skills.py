"""`momantu-bt skills`: what is installed, and how each skill is used."""

from __future__ import annotations

import inspect
import json
from typing import Annotated, Any

import typer

from momantu_bt.cli.help import help_of
from momantu_bt.cli.listing import first_line, listing
from momantu_bt.cli.skills_palette import print_palette
from momantu_bt.cli.skills_schema import schema
from momantu_bt.cli.skills_test import promises
from momantu_bt.plugins import SKILLS, load
from momantu_bt.skill import MISSING, Port, Skill
from momantu_bt.tree.types import label

skills = typer.Typer(rich_markup_mode=None, invoke_without_command=True)


@skills.callback(help="List the installed skills. `momantu-bt skills show pick` shows one.")
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


@skills.command("show", help="Show a skill's ports, what it uses and how it can fail.")
def show_one(
    name: Annotated[str, typer.Argument(help="The skill's name, as in trees.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> None:
    """Show one skill."""
    skill: type[Skill] = load(SKILLS, name)
    if as_json:
        typer.echo(json.dumps(_plain(name, skill), indent=2))
        return
    typer.echo(f"{name}: {inspect.getdoc(skill) or ''}")
    for direction, heading in (("in", "Inputs"), ("out", "Outputs")):
        ports = [port for port in skill.ports.values() if port.direction == direction]
        if ports:
            typer.echo(f"\n{heading}")
            for port in ports:
                typer.echo(f"  {port.name}: {_kind(port)}. {port.doc}")
    typer.echo(f"\nUses      {', '.join(sorted(skill.uses)) or 'no actuator'}")
    typer.echo(f"Needs     {', '.join(skill.needs) or 'no service'}")
    if skill.failures:
        typer.echo("\nFails with")
        for code, sentence in skill.failures.items():
            typer.echo(f"  {code}: {sentence}")


skills.command("schema", help=help_of(schema))(schema)
skills.command("test", help=help_of(promises))(promises)


def _kind(port: Port) -> str:
    words = label(port.type)
    if port.names is not None:
        words += f", a {port.names.replace('_', ' ')}"
    if port.unit is not None:
        words += f" in {port.unit}"
    if port.bounds:
        words += f", {port.bounds}"
    if port.direction == "out":
        return words
    if port.default is MISSING:
        return words + ", required"
    return words + ("" if port.default is None else f", else {port.default}")


def _plain(name: str, skill: type[Skill]) -> dict[str, Any]:
    return {
        "name": name,
        "doc": inspect.getdoc(skill) or "",
        "ports": [
            {
                "name": port.name,
                "direction": port.direction,
                "type": label(port.type),
                "unit": port.unit,
                "names": port.names,
                "least": port.least,
                "most": port.most,
                "required": port.required,
                "default": None if port.default is MISSING else str(port.default),
                "doc": port.doc,
            }
            for port in skill.ports.values()
        ],
        "uses": sorted(skill.uses),
        "needs": list(skill.needs),
        "one_of": [list(group) for group in skill.one_of],
        "failures": dict(skill.failures),
    }
