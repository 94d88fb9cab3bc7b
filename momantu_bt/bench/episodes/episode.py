"""Run one episode in this process and write its row."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
from pathlib import Path
from typing import Any

import momantu_bt.threads  # noqa: F401 - before numpy, which the next imports load
from momantu_bt.bench.planning.made_of import difference, made_of
from momantu_bt.bench.rows.spec import EpisodeSpec, Row
from momantu_bt.engine.executor import Executor, Observer
from momantu_bt.engine.node import TreeNode
from momantu_bt.errors import MomantuError
from momantu_bt.fault import FaultError
from momantu_bt.faults.spec import parse_fault
from momantu_bt.formats.files import write_whole
from momantu_bt.record.report import Report
from momantu_bt.running.launch import launch
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import prepare
from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry

_KEPT = (
    *("world", "robot", "status", "success", "failure", "unmet", "measures", "sim_time_s"),
    *("wall_time_s", "start_time_s", "fingerprint", "error", "incidents", "claims", "faults"),
    *("demands", "causes"),
)
"""Fields that a row copies unchanged from a report."""


class Refused(MomantuError):
    """The episode cannot be run as requested; nothing was started."""


def main(spec_file: str, row_file: str) -> int:
    """Run the episode that a JSON file tells, and write its row as JSON.

    Exit code EX_OK when a row was written, EX_UNAVAILABLE when its fault cannot happen here,
    EX_TEMPFAIL when it cannot begin.
    """
    signal.pthread_sigmask(signal.SIG_SETMASK, ())  # Ray workers pass their blocked signals on
    spec = EpisodeSpec.from_dict(json.loads(Path(spec_file).read_text(encoding="utf-8")))
    try:
        report, tries = run(spec)
    except FaultError as error:
        print(error, file=sys.stderr)
        return os.EX_UNAVAILABLE
    except MomantuError as error:
        print(error, file=sys.stderr)
        return os.EX_TEMPFAIL
    write_whole(Path(row_file), json.dumps(row_of(report, tries), default=str) + "\n")
    return os.EX_OK


def run(spec: EpisodeSpec) -> tuple[Report, int]:
    """Run it in this process; also how often its nodes tried again.

    Raises:
        Refused: the files or the code differ from those that the spec names.
        FaultError: the tree, the robot or the world cannot have the fault.
        TreeError, LaunchError, WorldError and the like: it cannot begin.
    """
    options = RunOptions(
        world=spec.world,
        robot=spec.robot,
        goal=spec.goal,
        map=spec.map,
        names=spec.names,
        seed=spec.seed,
        values=dict(spec.values),
        max_time=spec.max_time,
        referee=spec.referee,
        audit=True,
        record=None if spec.record is None else Path(spec.record),
        faults=() if spec.fault is None else (parse_fault(spec.fault),),
    )
    prepared = prepare(spec.tree, options)
    _check(spec, prepared.document, prepared.registry)
    if spec.record is not None:
        shutil.rmtree(spec.record, ignore_errors=True)  # left by an interrupted attempt
    executors: list[Executor] = []

    def watch(executor: Executor) -> list[Observer]:
        executors.append(executor)
        return []

    report = launch(prepared, watch)
    return report, sum(map(_tries, executors[0].built.nodes))


def _check(spec: EpisodeSpec, document: Document, registry: Registry) -> None:
    """Files edited since, or other versions on another machine, do not mix into the results."""
    made = made_of(
        document,
        registry,
        world=spec.world,
        robot=spec.robot,
        goal=spec.goal,
        map_=spec.map,
        names=spec.names,
        values=spec.values,
        max_time=spec.max_time,
        referee=spec.referee,
    )
    if changed := difference(spec.made_of, made):
        raise Refused(
            f"{', '.join(changed)}: not what it was when the bench began; begin it anew, "
            "or undo the change and go on"
        )


def _tries(node: TreeNode) -> int:
    """How often a node restarted its first child after a failure."""
    spec = NODES.get(node.model.type)
    if spec is None or not spec.retries or not node.kids:
        return 0
    return max(0, node.kids[0].runs - node.runs)


def row_of(report: Report, tries: int) -> Row:
    """The fields of a report that a row stores."""
    told: dict[str, Any] = report.as_dict()
    row = {name: told[name] for name in _KEPT}
    row["tries"] = tries
    row["nodes"] = [{k: v for k, v in node.items() if v} for node in told["nodes"]]
    return row
