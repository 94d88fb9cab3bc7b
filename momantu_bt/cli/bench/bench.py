"""`momantu-bt bench`: how often a tree works, and why not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
    Settings,
    Values,
)
from momantu_bt.errors import ExitCode
from momantu_bt.formats.files import check_writable
from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.lazy import lazily

with lazily():
    from momantu_bt.bench.episodes import carry_out
    from momantu_bt.bench.reports import coverage_text, tables
    from momantu_bt.bench.reports import matrix as matrices
    from momantu_bt.bench.reports import report as reports
    from momantu_bt.bench.rows import store as results
    from momantu_bt.bench.statistics import coverage as coverages
    from momantu_bt.bench.statistics import summary
    from momantu_bt.cli.bench import merge as bench_merge
    from momantu_bt.cli.bench import progress as bench_progress
    from momantu_bt.cli.bench import setup as bench_setup
    from momantu_bt.cli.shared import given

if TYPE_CHECKING:
    from momantu_bt.bench.planning.plan import Plan
    from momantu_bt.bench.rows.spec import Row
    from momantu_bt.faults.matrix import Row as Demand
    from momantu_bt.tree.model import Document


def bench(
    tree: Annotated[
        list[str],
        typer.Argument(
            metavar="TREE", help="A tree file, or the name of a bundled tree; folders for --merge."
        ),
    ],
    seeds: Seeds = "0:30",
    jobs: Jobs = None,
    world: Annotated[
        str | None, typer.Option(help="A world's name. Default: the tree's own.")
    ] = None,
    robot: Robot = None,
    map_: MapTold = None,
    names: NamesTold = None,
    set_: Settings = None,
    values: Values = None,
    max_time: MaxTime = 600.0,
    referee: Judged = True,
    goal: GoalGiven = None,
    episode_limit: EpisodeLimit = 900.0,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="FAULT", help="Inject this fault, once for each seed."),
    ] = None,
    faults: Annotated[
        str | None,
        typer.Option(metavar="all|GLOB", help="All faults, or those like camera.*,skill.*."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. Default: runs/bench/<tree>.")
    ] = None,
    shard: Annotated[
        str | None, typer.Option(metavar="I/N", help="Only every N-th episode, from the I-th.")
    ] = None,
    merge: Annotated[
        bool, typer.Option("--merge", help="Run nothing; merge folders of results into --out.")
    ] = False,
    engine: Runner = "local",
    ray_address: RayAddress = None,
    record: Kept = "failures",
    coverage: Annotated[
        bool, typer.Option("--coverage", help="Print the tree with how often each line ran.")
    ] = False,
    report: Annotated[
        Path | None, typer.Option(help="Write figures and rows to this JSON.")
    ] = None,
    demand: Annotated[
        float | None,
        typer.Option(
            min=0.0, max=1.0, help="Exit 1 when the lower limit of the rate is below this."
        ),
    ] = None,
) -> ExitCode:
    """Run a tree many times, each time with another seed and in a process of its own.

    With --fault or --faults something is broken in each, and a table says what became of it.
    Rows are kept in a folder as they come. The same command goes on where it was stopped; rows
    of other files, versions or options are not mixed in.

    Exit code 0: every episode has a row, whatever it says; 1: some are missing, or --demand is
    not met; 2: the tree or the arguments are wrong; 130: interrupted.

    Examples:
      momantu-bt bench bring_object --seeds 0:100
      momantu-bt bench trees/bring_object.yaml --seeds 0:500 --jobs 8 --report bench.json
      momantu-bt bench my_tree.yaml --seeds 0:50 --set "speed=0.5 m/s" --demand 0.9
      momantu-bt bench bring_object --seeds 0:10 --faults all
      momantu-bt bench bring_object --seeds 0:20 --map maps/office
      momantu-bt bench bring_object --seeds 0:500 --engine ray --ray-address 10.0.0.4:6379
      momantu-bt bench --merge machine_1 machine_2 --out both
    """
    options = _Options(out, shard, (engine, jobs, ray_address), coverage, report, demand)

    if merge:
        return bench_merge.merge_folders(tree, out, report)
    place = bench_setup.one_tree(tree)
    chosen = bench_setup.choose(record, RECORD, "--record")
    board = given.given_values(set_ or [], values)
    demands = bench_setup.demands_of(place, fault or [], faults)
    broken: list[str | None] = [demand.fault for demand in demands] or [None]
    how = bench_setup.HowToRun(
        *(world, robot, board, max_time, referee, episode_limit, chosen, broken),
        goal=given.given_goal(goal),
        map=map_,
        names=names,
    )
    plan, document = bench_setup.plan_of(place, parse_seeds(seeds), how)
    bench_setup.check_faults(fault or [], document, how)
    return _bench(plan, document, demands, options)


@dataclass(frozen=True, slots=True)
class _Options:
    out: Path | None
    shard: str | None
    engine: tuple[str, int | None, str | None]
    coverage: bool
    report: Path | None
    demand: float | None


def _bench(
    plan: Plan, document: Document, demands: Sequence[Demand], options: _Options
) -> ExitCode:
    """Run the missing episodes, then print the results of all."""
    streams.keep_on(notice)
    part = plan.wanted.shard(*bench_setup.shard_of(options.shard))
    engine = bench_setup.engine_of(*options.engine)
    if options.report is not None:
        check_writable(options.report)
    folder = options.out or OUT / Path(plan.tree).stem
    with results.Store(folder) as store:
        bench_setup.say_others(plan, store)
        bench_setup.keep_plan(plan, store)
        ended = carry_out.carry_out([(plan.of(part), store)], engine, bench_progress.progress())
        rows, missing = part.present(store.rows), part.missing(store.rows)
    _say(plan, rows, document, demands, options)
    bench_setup.say_refused(ended)
    bench_setup.say_missing(missing)
    if ended.interrupted:
        return ExitCode.INTERRUPTED
    failed = missing or _falls_short(rows, options.demand)
    return ExitCode.FAILURE if failed else ExitCode.SUCCESS


def _say(
    plan: Plan,
    rows: Sequence[Row],
    document: Document,
    demands: Sequence[Demand],
    options: _Options,
) -> None:
    """Print the figures, and write them if that is wanted."""
    name = Path(plan.tree).name + (", with faults" if demands else "")
    typer.echo(tables.summary_text(name, summary.Summary.of(rows)))
    more: dict[str, Any] = {}
    if demands:
        matrix = matrices.Matrix.of(demands, rows)
        typer.echo(f"\n{matrices.matrix_text(matrix)}")
        more["matrix"] = matrix.as_dict()
    if options.coverage:
        points = coverages.coverage(document, rows)
        typer.echo(f"\n{coverage_text.coverage_text(points, document.source)}")
        more["coverage"] = [point.as_dict() for point in points]
    if options.report is not None:
        reports.write_report(options.report, reports.report(rows, more))
        typer.echo(f"report: {options.report}")


def _falls_short(rows: Sequence[Row], demand: float | None) -> bool:
    """Whether the rate is not surely as high as demanded; said in a line."""
    if demand is None:
        return False
    low, _ = summary.Summary.of(rows).interval
    if low >= demand:
        return False
    typer.echo(f"the lower limit {100 * low:.1f} % is below {100 * demand:g} %", err=True)
    return True
