"""`momantu-bt replay`: step through a recorded run, or tick its tree again without the world."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from momantu_bt.errors import ExitCode
from momantu_bt.lazy import lazily
from momantu_bt.version import __version__

with lazily():
    from rich import console

    from momantu_bt import page
    from momantu_bt.cli.replay import records
    from momantu_bt.cli.replay import screen as replay_screen
    from momantu_bt.cli.run import terminal
    from momantu_bt.replay import moment_text, rebuild, recheck, run_text, seek, stepper
    from momantu_bt.replay import timeline as timelines
    from momantu_bt.tree import registry

if TYPE_CHECKING:
    from momantu_bt.record.recording import Recording
    from momantu_bt.replay.timeline import Timeline


def replay(
    run: Annotated[Path, typer.Argument(help="The folder of a record.")],
    at: Annotated[
        float | None, typer.Option(help="Print the moment at this time, in s, and exit.")
    ] = None,
    node: Annotated[
        str | None,
        typer.Option(help="Print the first moment at which a node changes: its name or line."),
    ] = None,
    failure: Annotated[
        int | None, typer.Option(help="Print the moment of a failure: 1 is the first, -1 the last.")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="Print the moment as JSON.")] = False,
    html: Annotated[
        Path | None, typer.Option(help="Write the run as one HTML page, for any browser.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Tick the tree again; it must do the same.")
    ] = False,
) -> ExitCode:
    """Step through a recorded run; without a terminal, print its lines.

    On a terminal, keys step through it; ? shows them. With --at and --node, --node is sought from
    that time on.

    Exit code 0: it was shown, and with --check the tree did the same; 1: it did not; 2: there is
    no such record, or no such moment in it.

    Examples:
      momantu-bt replay runs/3
      momantu-bt replay runs/3 --at 42.5
      momantu-bt replay runs/3 --failure -1 --json
      momantu-bt replay runs/3 --html run.html
      momantu-bt replay runs/3 --check
    """
    recording = records.open_record(run)
    if check:
        return _check(recording)
    if html is not None:
        return _write_page(recording, html)
    timeline = timelines.Timeline(recording)
    chosen = (at, node, failure) != (None, None, None)
    index = _chosen(timeline, at, node, failure)
    if chosen or json_:
        _print_moment(timeline, index, as_json=json_)
    elif terminal.is_interactive():
        _step(timeline)
    else:
        _print_all(recording)
    return ExitCode.SUCCESS


def _chosen(timeline: Timeline, at: float | None, node: str | None, failure: int | None) -> int:
    """The index of the requested moment; the last one by default.

    Raises:
        SeekError: the record has no such moment.
    """
    if failure is not None:
        found = seek.failures(timeline.recording)
        if not 1 <= abs(failure) <= len(found):
            counted = f"{len(found)}; 1 is the first, -1 the last" if found else "none"
            raise seek.SeekError(f"there is no failure {failure}; the record has {counted}")
        return found[failure - 1 if failure > 0 else failure].index
    start = -1 if at is None else timeline.at(at)
    if node is None:
        return len(timeline) - 1 if at is None else start
    indices = seek.changes_of(timeline.recording, seek.matching(timeline.recording, node))
    index = seek.following(indices, start - 1)
    if index is None:
        since = "" if at is None else f" from {at:g} s on"
        raise seek.SeekError(f"{node} never changes{since}")
    return index


def _write_page(recording: Recording, path: Path) -> ExitCode:

    page.write_page(recording, path)
    typer.echo(f"{path}: open it in a browser")
    return ExitCode.SUCCESS


def _print_moment(timeline: Timeline, index: int, *, as_json: bool) -> None:

    moment = timeline.moment(index)
    if as_json:
        typer.echo(json.dumps(moment_text.moment_data(moment), indent=2, default=str))
        return
    for line in moment_text.moment_lines(moment):
        typer.echo(line)


def _print_all(recording: Recording) -> None:

    typer.echo(run_text.headline(recording))
    for _, line in run_text.run_lines(recording):
        typer.echo(line)
    typer.echo(run_text.ending(recording))


def _step(timeline: Timeline) -> None:

    recording = timeline.recording
    typer.echo(run_text.headline(recording))
    replay_screen.show(
        stepper.Stepper(timeline), list(run_text.run_lines(recording)), console.Console()
    )
    typer.echo(run_text.ending(recording))


def _check(recording: Recording) -> ExitCode:

    try:
        result = recheck.recheck(recording, registry.Registry.installed())
    except rebuild.RebuildError as error:
        raise rebuild.RebuildError(f"{recording.folder}: {error}") from None
    different = result.difference
    if different is None:
        typer.echo(f"the tree did the same in all {result.ticks} ticks")
        return ExitCode.SUCCESS
    where = f" of {different.where}" if different.where else ""
    typer.echo(
        f"after {result.ticks} equal ticks, in tick {different.tick}, {different.now:.2f} s: "
        f"another {different.kind}{where}"
    )
    typer.echo(f"  recorded: {different.left}")
    typer.echo(f"  here:     {different.right}")
    recorded = recording.about["versions"].get("momantu-bt", "an unknown version")
    if recorded != __version__:
        typer.echo(f"the record is of momantu-bt {recorded}, this is {__version__}")
    return ExitCode.FAILURE
