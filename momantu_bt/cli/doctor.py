"""`momantu-bt doctor`: checks what a run needs, and names the cure for each problem."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from momantu_bt.cli.verbs import COMMANDS
from momantu_bt.descriptions.tunables import TUNABLES
from momantu_bt.detector import DETECTORS
from momantu_bt.diagnosis import Diagnosis
from momantu_bt.diagnosis.machine import machine
from momantu_bt.diagnosis.packages import packages
from momantu_bt.diagnosis.plugins import plugins
from momantu_bt.errors import ExitCode
from momantu_bt.faults.kinds.catalogue import FAULTS
from momantu_bt.labelled import RENDERERS
from momantu_bt.plugins import Group
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.catalogue.nodes import BEHAVIOURS
from momantu_bt.tree.catalogue.nodes import PLUGINS as NODES
from momantu_bt.tree.plugins import SERVICES, SKILLS
from momantu_bt.world_plugins import WORLD_FILES, WORLDS

GROUPS: tuple[Group[Any], ...] = (
    SKILLS,
    NODES,
    BEHAVIOURS,
    SERVICES,
    DETECTORS,
    RENDERERS,
    TUNABLES,
    ROBOTS,
    WORLDS,
    WORLD_FILES,
    FAULTS,
    COMMANDS,
)
"""Every entry point group; each plug-in is loaded once."""


def doctor(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")] = False,
    fix: Annotated[
        bool, typer.Option("--fix", help="Carry out the cures that can be automated.")
    ] = False,
    output: Annotated[Path, typer.Option(help="The folder for reports and videos.")] = Path(),
) -> ExitCode:
    """Check Python, packages, Vulkan, memory and folders, and name the cure for each problem.

    Exit code 0: nothing is wrong; 1: something is.

    Examples:
      momantu-bt doctor
      momantu-bt doctor --fix
      momantu-bt doctor --json
    """
    found: list[Diagnosis] = []
    for diagnosis in diagnose(output):
        if fix and not diagnosis.ok and diagnosis.mend is not None:
            diagnosis = mended(diagnosis)
        found.append(diagnosis)
        if not as_json:
            _say(diagnosis)
    wrong = [diagnosis for diagnosis in found if not diagnosis.ok]
    if as_json:
        report = {"ok": not wrong, "diagnoses": [diagnosis.as_dict() for diagnosis in found]}
        typer.echo(json.dumps(report, indent=2))
    else:
        typer.echo(_closing(wrong))
    return ExitCode.FAILURE if wrong else ExitCode.SUCCESS


def diagnose(output: Path) -> Iterator[Diagnosis]:
    """Everything there is to look at, the quick and the certain first."""
    yield from machine(output)
    yield from packages()
    yield from plugins(GROUPS)


def mended(diagnosis: Diagnosis) -> Diagnosis:
    """Carry out a cure; the result says whether it worked."""
    if diagnosis.mend is None:
        return diagnosis
    try:
        result = diagnosis.mend()
    except (OSError, RuntimeError) as error:
        return Diagnosis(diagnosis.name, False, f"could not be mended: {error}", diagnosis.cure)
    return Diagnosis(diagnosis.name, True, f"mended ({result})" if result else "mended")


def _say(diagnosis: Diagnosis) -> None:
    colour = typer.colors.GREEN if diagnosis.ok else typer.colors.RED
    sign = typer.style("ok   " if diagnosis.ok else "WRONG", fg=colour)
    typer.echo(f"{sign} {diagnosis.name}: {diagnosis.detail}")
    if not diagnosis.ok and diagnosis.cure:
        typer.echo(f"      cure: {diagnosis.cure}")


def _closing(wrong: list[Diagnosis]) -> str:
    if not wrong:
        return "Nothing is wrong."
    mendable = any(diagnosis.mend is not None for diagnosis in wrong)
    hint = " `momantu-bt doctor --fix` can mend some." if mendable else ""
    return f"{len(wrong)} wrong: {', '.join(diagnosis.name for diagnosis in wrong)}.{hint}"
