"""`momantu_bt.run`: a tree, from its file to its report, in one call."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from momantu_bt.engine.person import Scripted
from momantu_bt.faults.spec import parse_fault
from momantu_bt.record.report import Report
from momantu_bt.running.launch import Watch, launch
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import prepare
from momantu_bt.tree.registry import Registry
from momantu_bt.world import World


def run(
    tree: str | Path,
    *,
    world: str | World | None = None,
    robot: str | None = None,
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
    faults: Iterable[str] = (),
    patience: float = math.inf,
    record: Path | None = None,
) -> Report:
    """Run a tree file, or a bundled tree by name.

    Most arguments are those of `RunOptions`; these are not, or are written otherwise:

    report: where to write it as JSON. registry: what trees can name; everything installed
    unless given. watch: makes observers of the run. answers: what `ask` and `confirm` are told,
    in turn; afterwards nobody answers. faults: such as `camera.dead@12 s`.
    patience: seconds of wall time that a skill's step may take; what hangs longer in native code
    ends the process, which is yours: so there is no limit unless one is given.

    Raises:
        TreeNotFound: there is no such tree.
        TreeError: the tree has errors; all of them are in it.
        LaunchError: the run cannot begin as asked.
        WorldError: the world could not start.
        FaultError: no fault is written so, or this run cannot have it.
        OutputError: the record's folder cannot be written, or holds a record already.
    """
    options = RunOptions(
        world=world,
        robot=robot,
        seed=seed,
        values=values or {},
        substitute=None if substitute is None else Path(substitute),
        faults=tuple(parse_fault(text) for text in faults),
        max_time=max_time,
        realtime=realtime,
        referee=referee,
        audit=audit,
        patience=patience,
        record=record,
        person=Scripted(answers),
    )
    result = launch(prepare(str(tree), options, registry), watch)
    if report is not None:
        result.write(report)
    return result
