"""`momantu-bt compare`: which of two trees works more often, on the same seeds."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from momantu_bt.cli.shared import streams
from momantu_bt.cli.shared.notices import notice
from momantu_bt.cli.shared.options import (
    OUT,
    RECORD,
    EpisodeLimit,
    GoalGiven,
    Jobs,
    Judged,
    Kept,
    MapTold,
    MaxTime,
    NamesTold,
    RayAddress,
    Robot,
    Runner,
    Seeds,
    Values,
)
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt.bench.episodes import carry_out
    from momantu_bt.bench.reports import report as reports
    from momantu_bt.bench.reports import tables
    from momantu_bt.bench.rows import store as results
    from momantu_bt.bench.statistics import paired as pairs
    from momantu_bt.bench.statistics import summary as figures
    from momantu_bt.cli.bench import progress as bench_progress
    from momantu_bt.cli.bench import setup as bench_setup
    from momantu_bt.cli.shared import given

if TYPE_CHECKING:
    from momantu_bt.bench.episodes.engine import Engine
    from momantu_bt.bench.planning.plan import Plan
    from momantu_bt.bench.rows.spec import Row


def compare(
    tree_a: Annotated[str, typer.Argument(metavar="A", help="A tree file or bundled tree.")],
    tree_b: Annotated[str, typer.Argument(metavar="B", help="Another one.")],
    seeds: Seeds = "0:30",
    jobs: Jobs = None,
    world: Annotated[
        str | None, typer.Option(help="A world's name. Default: the trees' own.")
    ] = None,
    robot: Robot = None,
    map_: MapTold = None,
    names: NamesTold = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help="key=value: a value of both trees' blackboards."),
    ] = None,
    values: Values = None,
    max_time: MaxTime = 600.0,
    referee: Judged = True,
    goal: GoalGiven = None,
    episode_limit: EpisodeLimit = 900.0,
    out: Annotated[
        Path, typer.Option(help="Folder with a folder of results for each tree, as bench's.")
    ] = OUT,
    engine: Runner = "local",
    ray_address: RayAddress = None,
    record: Kept = "failures",
    report: Annotated[Path | None, typer.Option(help="Write all figures to this JSON.")] = None,
) -> ExitCode:
    """Run two trees on the same seeds, and say whether one works more often or faster.

    Rows are kept where `bench` keeps them, so that what either has run already is not run again.

    Exit code 0: every episode has a row, whoever is better; 1: some are missing; 2: a tree or an
    argument is wrong; 130: interrupted.

    Examples:
      momantu-bt compare bring_object bring_object_plain --seeds 0:100
      momantu-bt compare old.yaml new.yaml --seeds 0:50 --report comparison.json
    """
    chosen = bench_setup.choose(record, RECORD, "--record")
    board = given.given_values(set_ or [], values)
    how = bench_setup.HowToRun(
        world,
        robot,
        board,
        max_time,
        referee,
        episode_limit,
        chosen,
        goal=given.given_goal(goal),
        map=map_,
        names=names,
    )
    plans = [bench_setup.plan_of(tree, parse_seeds(seeds), how)[0] for tree in (tree_a, tree_b)]
    if plans[0].wanted == plans[1].wanted:
        raise InputError(f"{tree_a} and {tree_b} are the same; name two different trees")
    if report is not None:
        check_writable(report)
    return _compare(plans, bench_setup.engine_of(engine, jobs, ray_address), out, report)


def _compare(plans: list[Plan], engine: Engine, out: Path, report: Path | None) -> ExitCode:
    """Run the missing episodes of both in turn, then print how they differ."""
    streams.keep_on(notice)
    names = [Path(plan.tree).stem for plan in plans]
    if names[0] == names[1]:
        names[1] += "-2"
    with ExitStack() as stack:
        stores = [stack.enter_context(results.Store(out / name)) for name in names]
        work = list(zip(plans, stores, strict=True))
        for plan, store in work:
            bench_setup.say_others(plan, store)
            bench_setup.keep_plan(plan, store)
        ended = carry_out.carry_out(work, engine, bench_progress.progress())
        rows = [plan.wanted.present(store.rows) for plan, store in work]
        missing = [
            f"{words} of {name}"
            for name, (plan, store) in zip(names, work, strict=True)
            for words in plan.wanted.missing(store.rows)
        ]
    _say(names, rows, report)
    bench_setup.say_refused(ended)
    bench_setup.say_missing(missing)
    if ended.interrupted:
        return ExitCode.INTERRUPTED
    return ExitCode.FAILURE if missing else ExitCode.SUCCESS


def _say(names: list[str], rows: list[list[Row]], report: Path | None) -> None:

    summaries = [figures.Summary.of(each) for each in rows]
    for name, summary in zip(names, summaries, strict=True):
        typer.echo(tables.summary_text(name, summary) + "\n")
    paired = pairs.Paired.of(*rows)
    typer.echo(pairs.paired_text(paired, *names))
    if report is not None:
        trees = [
            {"tree": name, **summary.as_dict()}
            for name, summary in zip(names, summaries, strict=True)
        ]
        reports.write_report(report, {"a": trees[0], "b": trees[1], "paired": paired.as_dict()})
        typer.echo(f"report: {report}")
