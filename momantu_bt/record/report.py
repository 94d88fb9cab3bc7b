"""The report of a run, as a value and as a JSON file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from momantu_bt.engine.ending import ERROR, INTERRUPTED, SUCCESS
from momantu_bt.errors import ExitCode
from momantu_bt.failure import FailureValue
from momantu_bt.formats.files import write_whole
from momantu_bt.messages import plain
from momantu_bt.world import Demanded, Incident


@dataclass(frozen=True, slots=True)
class NodeReport:
    """One node: how often it was ticked, started and failed, and its active simulated seconds.

    slow_ticks: number of ticks in which its skill took longer than 20 ms of wall time outside
    `compute`. slowest_s: the longest of them.
    conditions: by name (`skip_if`), how often it was evaluated and how often it was true.
    answered: for each handler under `catch`, in order, how many failures it has handled.
    """

    name: str
    type: str
    place: str
    ticks: int
    runs: int
    failures: int
    seconds: float
    slow_ticks: int = 0
    slowest_s: float = 0.0
    conditions: Mapping[str, Sequence[int]] = field(default_factory=dict)
    answered: Sequence[int] = ()


@dataclass(frozen=True, slots=True)
class FalseClaim:
    """A skill's result that is false by ground truth: at time (s), of the node at place.

    code: the failure's code; None for SUCCESS. claim: the sentences that were judged.
    """

    time: float
    place: str
    code: str | None
    claim: str


@dataclass(frozen=True, slots=True)
class SkillClaims:
    """The claims of one skill, compared with ground truth.

    runs: how often the skill ended. judged_successes, judged_failures: number of results with a
    claim that the world could judge. false_successes: successes that were not true.
    false_failures: false alarms. lies: both kinds of false results, ordered by time.
    """

    runs: int = 0
    successes: int = 0
    judged_successes: int = 0
    false_successes: int = 0
    failures: int = 0
    judged_failures: int = 0
    false_failures: int = 0
    lies: tuple[FalseClaim, ...] = ()


@dataclass(frozen=True, slots=True)
class FaultReport:
    """One requested fault. fault: its text, with the resolved phase.

    began: s; None if its phase never started. ended: s; None if the fault did not end.
    """

    fault: str
    began: float | None
    ended: float | None


@dataclass(frozen=True, slots=True)
class Report:
    """How a run ended.

    status: SUCCESS or FAILURE of the tree, INTERRUPTED, or ERROR. success: the referee's verdict;
    None without a referee or a goal. unmet, measures, causes, demands: from the verdict. failure:
    why the tree failed, with the causes.
    sim_time_s: the world's clock at the tree's end. wall_time_s: from the first tick to the last.
    start_time_s: wall time before the first tick. ticks: number of ticks of the tree. blackboard:
    the root's values at the end. error: traceback of an internal error. incidents: dangerous events
    that the referee saw. claims: results of the audit by the skill's name in the tree; None without
    an audit. faults: the requested faults. interrupted_by: the signal that ended the run, such as
    SIGTERM. remarks: what was said to a person besides, such as a display that broke. lost: files
    that were asked for and could not be written.
    """

    tree: str
    world: str | None
    robot: str | None
    seed: int
    status: str
    success: bool | None
    failure: FailureValue | None
    unmet: tuple[str, ...]
    measures: Mapping[str, float]
    sim_time_s: float
    wall_time_s: float
    start_time_s: float
    ticks: int
    blackboard: Mapping[str, Any]
    nodes: tuple[NodeReport, ...]
    fingerprint: str
    versions: Mapping[str, str] = field(default_factory=dict)
    error: str | None = None
    incidents: tuple[Incident, ...] = ()
    demands: tuple[Demanded, ...] = ()
    causes: Mapping[str, str] = field(default_factory=dict)
    claims: Mapping[str, SkillClaims] | None = None
    faults: tuple[FaultReport, ...] = ()
    interrupted_by: str | None = None
    remarks: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second of wall time."""
        return self.sim_time_s / self.wall_time_s if self.wall_time_s > 0.0 else 0.0

    @property
    def exit_code(self) -> ExitCode:
        """The exit code of the command line."""
        if self.status == ERROR:
            return ExitCode.INTERNAL
        if self.status == INTERRUPTED:
            return ExitCode.INTERRUPTED
        if self.status != SUCCESS or self.success is False:
            return ExitCode.FAILURE
        return ExitCode.INTERNAL if self.lost else ExitCode.SUCCESS

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "tree": self.tree,
            "world": self.world,
            "robot": self.robot,
            "seed": self.seed,
            "status": self.status,
            "success": self.success,
            "failure": None if self.failure is None else finite(plain(self.failure.as_dict())),
            "unmet": list(self.unmet),
            "measures": finite(dict(self.measures)),
            "sim_time_s": self.sim_time_s,
            "wall_time_s": self.wall_time_s,
            "start_time_s": self.start_time_s,
            "real_time_factor": self.real_time_factor,
            "ticks": self.ticks,
            "blackboard": finite(plain(self.blackboard)),
            "nodes": [plain(node) for node in self.nodes],
            "fingerprint": self.fingerprint,
            "versions": dict(self.versions),
            "error": self.error,
            "incidents": [finite(plain(incident)) for incident in self.incidents],
            "demands": [plain(demand) for demand in self.demands],
            "causes": dict(self.causes),
            "claims": None if self.claims is None else plain(self.claims),
            "faults": [plain(fault) for fault in self.faults],
            "interrupted_by": self.interrupted_by,
            "remarks": list(self.remarks),
            "lost": list(self.lost),
        }

    def write(self, path: Path) -> None:
        """Write the report as JSON; OutputError if the file cannot be written."""
        write_whole(path, json.dumps(self.as_dict(), indent=2, default=str) + "\n")


def finite(value: Any) -> Any:
    """Replace infinities and NaN by texts, because JSON has neither."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    return value
