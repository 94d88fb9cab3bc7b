"""`momantu-bt run`: a tree, in a world, to its end."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from momantu_bt.cli.notices import notice
from momantu_bt.cli.options import Robot
from momantu_bt.errors import ExitCode, InputError, MomantuError

if TYPE_CHECKING:
    from momantu_bt.cli.breakpoints import Breakpoints
    from momantu_bt.cli.terminal import Terminal
    from momantu_bt.engine.executor import Executor, Observer
    from momantu_bt.fault import Fault
    from momantu_bt.record.report import Report
    from momantu_bt.tree.model import Document
    from momantu_bt.tree.substitute.substitution import Substitution

VIEW_PORT = 8080


def run(
    tree: Annotated[str, typer.Argument(help="A tree file, or the name of a bundled tree.")],
    world: Annotated[
        str | None, typer.Option(help="A world's name or file, or none; else the tree's own.")
    ] = None,
    robot: Robot = None,
    seed: Annotated[int, typer.Option(min=0, help="Varies the episode; same seed, same run.")] = 0,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="key=value: a value of the tree's board.")
    ] = None,
    values: Annotated[Path | None, typer.Option(help="A YAML file of values.")] = None,
    video: Annotated[Path | None, typer.Option(help="Film the run to this MP4 file.")] = None,
    view: Annotated[bool, typer.Option("--view", help="Serve the scene to a browser.")] = False,
    view_port: Annotated[int, typer.Option(help="The port of --view.")] = VIEW_PORT,
    record: Annotated[
        Path | None, typer.Option(help="A new folder for the report and a log of the whole run.")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write the report to this JSON file.")] = None,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="No faster than the simulated clock.")
    ] = False,
    max_time: Annotated[
        float, typer.Option(min=0.05, help="Simulated seconds after which the run fails.")
    ] = 600.0,
    referee: Annotated[
        bool, typer.Option("--referee/--no-referee", help="Whether somebody judges the run.")
    ] = True,
    substitute: Annotated[
        Path | None, typer.Option(help="A YAML file that says what nodes do instead, for tests.")
    ] = None,
    break_: Annotated[
        list[str] | None,
        typer.Option("--break", metavar="NODE", help="Stop before a node: its name, type or line."),
    ] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="FAULT", help="Break something; see momantu-bt faults."),
    ] = None,
    patience: Annotated[
        float,
        typer.Option(min=0.1, help="Wall-clock seconds after which a skill's step counts as hung."),
    ] = 60.0,
    unattended: Annotated[
        bool, typer.Option("--unattended", help="Nobody answers: questions take their default.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only the last line.")] = False,
) -> ExitCode:
    """Run a tree until it ends, and say what happened.

    Exit code 0: the tree succeeded and no referee denies it; 1: it failed, or the referee denies
    its success; 2: the tree or the arguments are wrong; 3: the world could not start; 4: an
    internal error; 130: interrupted.

    Examples:
      momantu-bt run bring_object
      momantu-bt run trees/bring_object.yaml --seed 3 --video run.mp4 --report run.json
      momantu-bt run bring_object --set "tag_edge=150 mm" --view
      momantu-bt run bring_object --robot my_robot/robot.yaml
      momantu-bt run bring_object --fault camera.dead@navigate:for=10s
    """
    from momantu_bt.cli.terminal import Terminal, is_interactive

    terminal = Terminal() if is_interactive() and not unattended else None
    wanted = _Outputs(video, view, view_port, record, report, quiet, terminal, break_ or [])
    try:
        start = _run(tree, world, robot, seed, set_ or [], values, substitute, wanted)
        result = start(
            max_time=max_time,
            realtime=realtime,
            referee=referee,
            patience=patience,
            faults=_faults(fault or []),
        )
    except KeyboardInterrupt:
        raise NotStarted("interrupted before the first tick; nothing was started") from None
    return result.exit_code


class NotStarted(MomantuError):
    """Ctrl-C came before the first tick."""

    exit_code = ExitCode.INTERRUPTED


@dataclass(frozen=True, slots=True)
class _Outputs:
    video: Path | None
    view: bool
    view_port: int
    record: Path | None
    report: Path | None
    quiet: bool
    terminal: Terminal | None
    breaks: Sequence[str]


def _faults(texts: Sequence[str]) -> tuple[Fault, ...]:
    from momantu_bt.faults.spec import parse_fault

    return tuple(parse_fault(text) for text in texts)


def _run(
    tree: str,
    world: str | None,
    robot: str | None,
    seed: int,
    settings: Sequence[str],
    values: Path | None,
    substitute: Path | None,
    wanted: _Outputs,
) -> Callable[..., Report]:
    """Check what was asked for; the result starts the run and says how it ended."""
    from momantu_bt.cli.given import given_values
    from momantu_bt.engine.launch import Options, launch
    from momantu_bt.tree.load import load
    from momantu_bt.tree.registry import Registry
    from momantu_bt.tree.substitute.substitution import Substitution, load_substitution

    registry = Registry.installed()
    board = given_values(settings, values)
    checked = load(tree, registry, world=world, robot=robot, values=board)
    replacing = Substitution()
    if substitute is not None:
        replacing = load_substitution(substitute, checked.document, registry, world)
    stops = _breakpoints(wanted, checked.document, replacing)
    _check_outputs(wanted)

    def start(**how: Any) -> Report:
        if wanted.terminal is not None:
            how["person"] = wanted.terminal
        options = Options(
            world=world,
            robot=robot,
            seed=seed,
            remark=notice,
            substitution=replacing,
            record=wanted.record,
            **how,
        )
        result = launch(checked.document, options, registry, lambda run: _watch(run, wanted, stops))
        if wanted.report is not None:
            result.write(wanted.report)
        _say_end(result, wanted)
        return result

    return start


def _breakpoints(
    wanted: _Outputs, document: Document, replacing: Substitution
) -> Breakpoints | None:
    """Where a person wants to stop, who must be there for it."""
    from momantu_bt.cli.breakpoints import Breakpoints

    if not wanted.breaks:
        return None
    if wanted.terminal is None:
        raise InputError("--break needs a person at a terminal, and no --unattended")
    return Breakpoints(wanted.breaks, document, wanted.terminal, replacing)


def _check_outputs(wanted: _Outputs) -> None:
    from momantu_bt.formats.files import check_writable

    for path in (wanted.report, wanted.video):
        if path is not None:
            check_writable(path)


def _watch(run: Executor, wanted: _Outputs, stops: Breakpoints | None) -> list[Observer]:
    """Observers of what the user asked to see; those opened are closed when one cannot be."""
    from momantu_bt.record.film import FilmObserver, ViewObserver

    observers: list[Observer] = []
    with ExitStack() as stack:

        def add(observer: Observer) -> None:
            stack.callback(observer.close)
            observers.append(observer)

        if (wanted.video is not None or wanted.view) and run.world is None:
            raise InputError("--video and --view need a world; this run has none")
        if wanted.video is not None and run.world is not None:
            add(FilmObserver(run.world.open_video(wanted.video, run.built.root.model.place.file)))
        if wanted.view and run.world is not None:
            scene = run.world.open_view(wanted.view_port)
            add(ViewObserver(scene))
            typer.echo(f"view: {scene.url}")
        if not wanted.quiet:
            add(_display(wanted.terminal))
        if stops is not None:
            stops.attach(run)
        stack.pop_all()
    return observers


def _display(terminal: Terminal | None) -> Observer:
    """A live tree on a terminal, plain lines elsewhere."""
    from momantu_bt.record.changes import ChangeLines

    if not sys.stdout.isatty():
        return ChangeLines(typer.echo)
    from rich.console import Console

    from momantu_bt.cli.live import LiveTree

    live = LiveTree(Console())
    if terminal is not None:
        terminal.display = live
    return live


def _say_end(result: Report, wanted: _Outputs) -> None:
    from momantu_bt.record.ending import ending_text

    if result.error is not None:
        typer.echo(result.error, err=True)
    named = (("report", wanted.report), ("video", wanted.video), ("record", wanted.record))
    places = [f"{what}: {path}" for what, path in named if path is not None]
    typer.echo("; ".join([ending_text(result), *places]))
