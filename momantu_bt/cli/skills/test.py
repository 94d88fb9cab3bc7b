"""`momantu-bt skills test`: test the rules for all skills on the installed ones."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.importing import output_aside
from momantu_bt.lazy import lazily
from momantu_bt.plugins import PluginError
from momantu_bt.tree.plugins import SKILLS

with lazily():
    from momantu_bt import testing


def promises(
    names: Annotated[
        list[str] | None, typer.Argument(help="Names of skills. Default: all.")
    ] = None,
    seed: Annotated[int, typer.Option(help="The seed of the runs.")] = 0,
    halts: Annotated[
        int, typer.Option(min=1, help="At how many ticks of a run each is halted, at most.")
    ] = 20,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
) -> ExitCode:
    """Test skills in a scripted room, without a simulator.

    Ports, codes, docs, clocks and random numbers; halting at each tick, starting again, dead
    sensors, and the same run twice. Exit code 1 when one does not pass.

    Examples:
      momantu-bt skills test
      momantu-bt skills test turn_round
    """
    passed, told = True, dict[str, list[Problem]]()
    for name in names or SKILLS:
        try:
            with output_aside():
                found = testing.check_skill(SKILLS.load(name), seed=seed, halts=halts)
        except PluginError as error:
            if names and name not in SKILLS:
                raise
            found = [Problem("broken", str(error))]
        told[name] = found
        wrong = any(finding.severity is not Severity.HINT for finding in found)
        passed = passed and not wrong
        if not as_json:
            typer.echo(f"{'WRONG' if wrong else 'ok   '} {name}")
            for finding in found:
                typer.echo(f"      {finding}")
    if as_json:
        shown = {name: [finding.as_dict() for finding in found] for name, found in told.items()}
        typer.echo(json.dumps({"ok": passed, "skills": shown}, indent=2))
    return ExitCode.SUCCESS if passed else ExitCode.FAILURE
