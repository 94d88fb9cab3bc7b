"""`momantu_bt.run`: a tree, from its file to its report, in one call."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from momantu_bt.engine.executor import Executor, Observer
from momantu_bt.engine.person import Scripted
from momantu_bt.errors import InputError
from momantu_bt.faults.spec import parse_fault
from momantu_bt.record.report import Report
from momantu_bt.record.view import ViewObserver
from momantu_bt.running.launch import Watch, launch
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import prepare
from momantu_bt.tree.files.given_text import AnyTree, tree_source
from momantu_bt.tree.registry import Registry
from momantu_bt.world import World


def run(
    tree: AnyTree,
    *,
    world: str | World | None = None,
    robot: str | None = None,
    goal: Any = None,
    map: str | Path | None = None,
    names: str | Path | None = None,
    measured_start: bool = False,
    seed: int = 0,
    values: Mapping[str, Any] | None = None,
    max_time: float = 600.0,
    realtime: bool = False,
    referee: bool = True,
    audit: bool = False,
    report: Path | None = None,
    registry: Registry | None = None,
    watch: Watch | None = None,
    answers: Iterable[str | bool] = (),
    substitute: str | Path | None = None,
    include: Iterable[str | Path] = (),
    faults: Iterable[str] = (),
    patience: float = math.inf,
    record: Path | None = None,
    view_port: int | None = None,
) -> Report:
    """Run a tree: a file, a bundled tree by name, a text, or a mapping.

    A `Path` is a file. A `str` with a line break, or one that begins with `<` or `{`, is a text in
    YAML or XML; any other is a path or a bundled tree's name. A mapping is what a YAML file would
    hold. Includes of a text or a mapping are found from the working directory.

    Most arguments are those of `RunOptions`. The others, or those with another form, are:
    report: path for the report as JSON. registry: the skills, worlds, robots and services that the
    tree can name; by default everything installed. watch: makes observers of the run. answers: the
    answers for `ask` and `confirm`, in order; after the last one, nobody answers. faults: texts
    such as `camera.dead@12 s`. patience: limit of wall time for a skill's step, s. There is none by
    default, as a hang in native code beyond the limit ends the process, which here is yours.
    view_port: where a browser sees the run until it ends; by default nowhere.

    Raises:
        InputError: the tree is none of these, or the mapping holds what a YAML file cannot.
        TreeNotFound: there is no such tree.
        TreeError: the tree has errors; the exception lists all of them.
        LaunchError: the run cannot begin with these arguments.
        WorldError: the world could not start.
        FaultError: a fault's text is not valid, or this run cannot have the fault.
        OutputError: the record's folder cannot be written, or holds a record already.
    """
    options = RunOptions(
        world=world,
        robot=robot,
        goal=goal,
        map=None if map is None else str(map),
        names=None if names is None else str(names),
        measured_start=measured_start,
        seed=seed,
        values=values or {},
        substitute=None if substitute is None else Path(substitute),
        include=tuple(Path(each) for each in include),
        faults=tuple(parse_fault(text) for text in faults),
        max_time=max_time,
        realtime=realtime,
        referee=referee,
        audit=audit,
        patience=patience,
        record=record,
        person=Scripted(answers),
    )
    shown = watch if view_port is None else _viewed(watch, view_port)
    result = launch(prepare(tree_source(tree), options, registry), shown)
    if report is not None:
        result.write(report)
    return result


def _viewed(watch: Watch | None, port: int) -> Watch:
    """The same observers, and one that keeps a view in a browser up to date."""

    def both(run: Executor) -> list[Observer]:
        if run.world is None:
            raise InputError("a view needs a world; this run has none")
        observers = [] if watch is None else list(watch(run))
        return [*observers, ViewObserver(run.world.open_view(port), run)]

    return both
