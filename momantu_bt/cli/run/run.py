"""`momantu-bt run`: run a tree in a world."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from momantu_bt.cli.shared import streams
from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.options import (
    TREE,
    VIEW_PORT,
    GoalGiven,
    Include,
    MapTold,
    NamesTold,
    RecordFolder,
    ReportTo,
    Robot,
    Seed,
    Settings,
    Undeclared,
    UndeclaredAre,
    Values,
    View,
    ViewPort,
)
from momantu_bt.cli.shared.starting import before_the_first_tick
from momantu_bt.errors import TRACEBACK, ExitCode, InputError
from momantu_bt.formats.files import check_writable
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt.cli.run import breakpoints, shield
    from momantu_bt.cli.run import report_file as reports
    from momantu_bt.cli.run import screen as screens
    from momantu_bt.cli.run import terminal as terminals
    from momantu_bt.cli.shared import given
    from momantu_bt.engine import interrupts, person
    from momantu_bt.faults import spec
    from momantu_bt.record import film
    from momantu_bt.record.text import ending
    from momantu_bt.running import launch as launching
    from momantu_bt.running import leftovers
    from momantu_bt.running import options as run_options
    from momantu_bt.running import prepare as preparing

if TYPE_CHECKING:
    from momantu_bt.cli.run.breakpoints import Breakpoints
    from momantu_bt.cli.run.report_file import ReportFile
    from momantu_bt.cli.run.screen import Screen
    from momantu_bt.cli.run.terminal import Terminal
    from momantu_bt.engine.executor import Executor, Observer
    from momantu_bt.record.report import Report
    from momantu_bt.running.options import RunOptions
    from momantu_bt.running.prepare import Prepared


def run(
    tree: Annotated[str, typer.Argument(help=TREE)],
    world: Annotated[
        str | None, typer.Option(help="A world's name or file, or none. Default: the tree's own.")
    ] = None,
    robot: Robot = None,
    map_: MapTold = None,
    names: NamesTold = None,
    seed: Seed = 0,
    set_: Settings = None,
    values: Values = None,
    video: Annotated[Path | None, typer.Option(help="Film the run to this MP4 file.")] = None,
    view: View = False,
    view_port: ViewPort = VIEW_PORT,
    record: RecordFolder = None,
    report: ReportTo = None,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="Run no faster than real time.")
    ] = False,
    max_time: Annotated[
        float, typer.Option(min=0.05, help="Simulated seconds after which the run fails.")
    ] = 600.0,
    referee: Annotated[
        bool, typer.Option("--referee/--no-referee", help="Whether the referee judges the run.")
    ] = True,
    goal: GoalGiven = None,
    substitute: Annotated[
        Path | None, typer.Option(help="A YAML file of rules that replace nodes, for tests.")
    ] = None,
    include: Include = None,
    undeclared: UndeclaredAre = Undeclared.ERROR,
    break_: Annotated[
        list[str] | None,
        typer.Option("--break", metavar="NODE", help="Stop before a node: its name, type or line."),
    ] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="FAULT", help="Inject a fault; see momantu-bt faults."),
    ] = None,
    patience: Annotated[
        float,
        typer.Option(min=0.1, help="Wall-clock seconds after which a skill's step counts as hung."),
    ] = 60.0,
    unattended: Annotated[
        bool,
        typer.Option("--unattended", help="Nobody answers questions: they take their default."),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print only the last line.")] = False,
) -> ExitCode:
    """Run a tree until it ends, and print what happened.

    Exit code 0: the tree succeeded and no referee denies it; 1: it failed, or the referee denies
    its success; 2: the tree or the arguments are wrong; 3: the world could not start; 4: an
    internal error, or a good run lost a file that was asked for; 130: interrupted.

    Examples:
      momantu-bt run bring_object
      momantu-bt run trees/bring_object.yaml --seed 3 --video run.mp4 --report run.json
      momantu-bt run bring_object --set "tag_edge=150 mm" --view
      momantu-bt run bring_object --robot my_robot/robot.yaml
      momantu-bt run bring_object --map maps/office
      momantu-bt run my_tree.yaml --map none --names maps/office
      momantu-bt run my_tree.yaml --goal "can on table_b beside tag"
      momantu-bt run bring_object --fault "camera.dead@12 s:for=10 s"
    """
    terminal = terminals.Terminal() if terminals.is_interactive() and not unattended else None
    options = run_options.RunOptions(
        world=world,
        robot=robot,
        map=map_,
        names=names,
        seed=seed,
        values=given.given_values(set_ or [], values),
        substitute=substitute,
        include=tuple(include or ()),
        tolerant=undeclared is Undeclared.WARN,
        faults=tuple(spec.parse_fault(text) for text in fault or []),
        max_time=max_time,
        realtime=realtime,
        referee=referee,
        goal=given.given_goal(goal),
        patience=patience,
        record=record,
        person=terminal or person.Scripted(),
        remark=notice,
    )
    shown = _Shown(video, view_port if view else None, report, quiet, terminal, break_ or [])
    with before_the_first_tick():
        return _run(tree, options, shown).exit_code


@dataclass(frozen=True, slots=True)
class _Shown:
    """The output for a person, during and after the run.

    view_port: port of the view in a browser; None: no view. terminal: where a person answers.
    breaks: nodes to stop before.
    """

    video: Path | None
    view_port: int | None
    report: Path | None
    quiet: bool
    terminal: Terminal | None
    breaks: Sequence[str]


def _run(tree: str, options: RunOptions, shown: _Shown) -> Report:
    """Check the arguments, run, and print how it ended."""
    prepared = preparing.prepare(given.given_tree(tree), options)
    stops = _breakpoints(shown, prepared)
    if shown.video is not None:
        check_writable(shown.video, regular=True)
    file = None if shown.report is None else reports.ReportFile(shown.report)
    lost: list[str] = []
    outputs = sys.stdout, sys.stderr
    streams.keep_on(lambda text: None)  # what breaks now is told when the run begins
    with ExitStack() as stack:
        screen = screens.open_screen(prepared, shown.terminal, shown.view_port, quiet=shown.quiet)
        stack.callback(screen.close)
        prepared = replace(prepared, options=replace(prepared.options, stage=screen.stage))
        try:
            with leftovers.no_sudden_exit():
                result = launching.launch(
                    prepared, lambda run: _watch(run, shown, stops, lost, file, screen), outputs
                )
        except BaseException:
            if file is not None:
                file.withdraw()
            raise
        with interrupts.Interrupts() as late:
            late.patient = True  # a signal comes too late to stop anything
            result = replace(result, lost=(*result.lost, *lost))
            if file is not None:
                result = file.write(result)
            _say_end(result, options, shown)
        if shown.terminal is not None and result.interrupted_by is None:
            screen.keep_view(ending.ending_text(result))
    return result


def _breakpoints(shown: _Shown, prepared: Prepared) -> Breakpoints | None:
    """The breakpoints, which need a person at the terminal."""
    if not shown.breaks:
        return None
    if shown.terminal is None:
        raise InputError("--break needs a person at a terminal, and no --unattended")
    return breakpoints.Breakpoints(
        shown.breaks, prepared.document, shown.terminal, prepared.substitution
    )


def _watch(
    run: Executor,
    shown: _Shown,
    stops: Breakpoints | None,
    lost: list[str],
    report: ReportFile | None,
    screen: Screen,
) -> list[Observer]:
    """The requested observers; if one cannot be opened, the others are closed.

    lost: gets the film if it breaks off. report: says from now on that the run did not end.
    """
    streams.keep_on(run.context.remark)
    observers: list[Observer] = []
    with ExitStack() as stack:

        def add(observer: Observer, what: str, on_break: Callable[[], object] = int) -> None:
            shielded = shield.Shielded(observer, what, run.context.remark, on_break)
            stack.callback(shielded.close)
            observers.append(shielded)

        if shown.video is not None and run.world is None:
            raise InputError("--video and --view need a world; this run has none")
        if shown.video is not None and run.world is not None:
            video = shown.video
            opened = run.world.open_video(video.absolute(), run.built.root.model.place.file)
            add(film.FilmObserver(opened), f"the film {video}", lambda: lost.append(str(video)))
        if shown.view_port is not None and run.world is not None:
            add(screen.open_view(run.world, shown.view_port, run), "the view")
        if screen.display is not None:
            add(screen.display, "the display")
        if stops is not None:
            stops.attach(run)
        if report is not None:
            report.begin(run)
        stack.pop_all()
    return observers


def _say_end(result: Report, options: RunOptions, shown: _Shown) -> None:
    if result.error is not None:
        if os.environ.get(TRACEBACK):
            typer.echo(result.error, err=True)
        else:
            notice(f"set {TRACEBACK}=1 for the traceback; a report has it, too")
    named = (("report", shown.report), ("video", shown.video), ("record", options.record))
    there = [(what, path) for what, path in named if path is not None]
    places = [f"{what}: {path}" for what, path in there if str(path) not in result.lost]
    if result.lost:
        places.append(f"lost: {', '.join(result.lost)}")
    streams.say("; ".join([ending.ending_text(result), *places]))
