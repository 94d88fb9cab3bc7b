"""`momantu-bt teleop`: drive a robot with the keyboard."""

from __future__ import annotations

import math
import sys
from collections import ChainMap
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from momantu_bt import collector
from momantu_bt.cli.shared import streams
from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.options import (
    VIEW_PORT,
    RecordFolder,
    ReportTo,
    Robot,
    Seed,
    View,
    ViewPort,
)
from momantu_bt.cli.shared.starting import before_the_first_tick
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.lazy import lazily

with lazily():
    from rich import console as consoles

    from momantu_bt import teleoperation
    from momantu_bt.cli.run import report_file as reports
    from momantu_bt.cli.run import screen as screens
    from momantu_bt.cli.run import shield
    from momantu_bt.cli.run import terminal as terminals
    from momantu_bt.cli.teleop import abilities, cockpit, controls
    from momantu_bt.engine import interrupts
    from momantu_bt.record.text import ending
    from momantu_bt.running import launch as launching
    from momantu_bt.running import leftovers
    from momantu_bt.running import options as run_options
    from momantu_bt.running import prepare as preparing
    from momantu_bt.tree import registry as registries
    from momantu_bt.tree.files import given_text

if TYPE_CHECKING:
    from momantu_bt.cli.run.report_file import ReportFile
    from momantu_bt.cli.run.screen import Screen
    from momantu_bt.cli.teleop.cockpit import Cockpit, Seat
    from momantu_bt.engine.executor import Executor, Observer
    from momantu_bt.record.report import Report
    from momantu_bt.robot import RobotDescription
    from momantu_bt.running.options import RunOptions
    from momantu_bt.running.prepare import Prepared
    from momantu_bt.tree.registry import Registry

NAME = "teleop"
"""Name of the tree that runs, as reports and records have it."""


def teleop(
    world: Annotated[
        str | None, typer.Option(help="A world's name or file. Default: the first installed.")
    ] = None,
    robot: Robot = None,
    seed: Seed = 0,
    view: View = False,
    view_port: ViewPort = VIEW_PORT,
    record: RecordFolder = None,
    report: ReportTo = None,
) -> ExitCode:
    """Drive a robot with the keyboard of this terminal.

    The screen shows the keys. A key works as long as it is held: half a second after the last key
    the robot stands. The base stops before what its laser or its map shows, the arm before its
    limits and before it touches the robot itself. Space stops everything, x leaves.

    Exit code 0: you left; 1: a skill failed; 2: no terminal, or wrong arguments; 3: the world
    could not start; 4: an internal error; 130: interrupted by Ctrl-C or another signal.

    Examples:
      momantu-bt teleop
      momantu-bt teleop --world my_flat.yaml --robot my_robot/ --view
      momantu-bt teleop --seed 3 --record runs/by_hand
    """
    if not terminals.is_interactive():
        raise InputError(
            "teleop reads single keys: standard input and output must both be a terminal; without "
            "one, a script drives: see docs/teleop.md"
        )
    console = consoles.Console(file=sys.stdout)
    if console.is_dumb_terminal:
        raise InputError("teleop draws on the terminal, and TERM says that this one cannot")
    with before_the_first_tick():
        with collector.paused():
            drive = _prepared(world, robot, seed, record)
        return _run(drive, console, view_port if view else None, report).exit_code


@dataclass(frozen=True, slots=True)
class _Drive:
    """What will run. seat: where its commands come from."""

    prepared: Prepared
    description: RobotDescription
    seat: Seat


def _prepared(world: str | None, robot: str | None, seed: int, record: Path | None) -> _Drive:
    """The tree of all skills that let a person drive this robot, ready to run.

    Raises:
        InputError: no world is installed, or no skill drives the robot. TreeError: there is no such
            world or robot, or its file has mistakes.
    """
    registry = registries.Registry.installed()
    name = world or next(iter(registry.worlds), None)
    if name is None or name == "none":
        raise InputError("teleop needs a world with a robot; give one with --world")
    options = run_options.RunOptions(
        world=name, robot=robot, seed=seed, max_time=math.inf, realtime=True, record=record
    )
    nothing = given_text.TreeText("momantu_bt: 1\ntrees: {Nothing: [succeed]}\n", f"<{NAME}>")
    checked = preparing.prepare(nothing, options, registry)
    entry = checked.registry.worlds[name]
    description = checked.registry.description(robot or entry.default_robot)
    driven = abilities.drivers(registry, description)
    if not driven:
        raise InputError(f"no installed skill lets a person drive {description.name}")
    seat = cockpit.Seat(controls.Controls(abilities.abilities(description, driven)))
    tree = given_text.TreeText(_tree(driven), f"{NAME}.yaml")
    prepared = preparing.prepare(tree, options, _operated(registry, seat))
    return _Drive(prepared, description, seat)


def _tree(driven: Mapping[str, str]) -> str:
    skills = "\n".join(f"      - {skill}" for skill in dict.fromkeys(driven.values()))
    return f"momantu_bt: 1\ntrees:\n  {NAME}:\n    parallel_all:\n{skills}\n"


def _operated(registry: Registry, seat: Seat) -> Registry:
    """The registry with the person at the controls."""
    others: Any = registry.services  # ChainMap writes to its first mapping alone
    own = {teleoperation.OPERATOR: teleoperation.operated_by(seat)}
    return replace(registry, services=ChainMap(own, others))


def _run(
    drive: _Drive, console: consoles.Console, view_port: int | None, report: Path | None
) -> Report:
    """Run until the person leaves, and print how it ended."""
    prepared, name = drive.prepared, drive.description.name
    file = None if report is None else reports.ReportFile(report)
    headline = f"{NAME}: {name} in {prepared.options.world_name}"
    if prepared.options.record is not None:
        headline += f", recorded in {prepared.options.record}"
    if view_port is not None:
        headline += f", view at port {view_port}"
    place = cockpit.Cockpit(console, drive.seat, headline)
    outputs = sys.stdout, sys.stderr
    streams.keep_on(lambda text: None)
    with ExitStack() as stack:
        screen = screens.open_screen(prepared, None, view_port, quiet=True)
        stack.callback(screen.close)
        stack.callback(place.close)
        typer.echo(f"preparing: {name} in {prepared.options.world_name}")
        options = replace(prepared.options, stage=screen.stage, remark=place.remark)
        try:
            with leftovers.no_sudden_exit():
                result = launching.launch(
                    replace(prepared, options=options),
                    lambda run: _watch(run, place, drive, screen, view_port, file),
                    outputs,
                )
        except BaseException:
            if file is not None:
                file.withdraw()
            raise
        finally:
            place.close()
            for remark in place.remarks:
                notice(remark)
        with interrupts.Interrupts() as late:
            late.patient = True
            if file is not None:
                result = file.write(result)
            _say_end(result, options, report)
    return result


def _watch(
    run: Executor,
    place: Cockpit,
    drive: _Drive,
    screen: Screen,
    view_port: int | None,
    report: ReportFile | None,
) -> list[Observer]:
    """The observers: the view, and the terminal, which is taken over now."""
    streams.keep_on(run.context.remark)
    leave, remark = drive.seat.controls.leave, run.context.remark
    observers: list[Observer] = []
    with ExitStack() as stack:
        if view_port is not None and run.world is not None:
            view = screen.open_view(run.world, view_port, run)
            observers.append(shield.Shielded(view, "the view", remark, int))
            stack.callback(observers[-1].close)
        if report is not None:
            report.begin(run)
        place.open()
        observers.append(shield.Shielded(place, "the screen", remark, leave))
        stack.pop_all()
    return observers


def _say_end(result: Report, options: RunOptions, report: Path | None) -> None:
    named = (("report", report), ("record", options.record))
    there = [(what, path) for what, path in named if path is not None]
    places = [f"{what}: {path}" for what, path in there if str(path) not in result.lost]
    if result.lost:
        places.append(f"lost: {', '.join(result.lost)}")
    streams.say("; ".join([ending.ending_text(result), *places]))
