"""The head of the page: the tree, world, robot and versions, and how the run ended."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from momantu_bt.engine.ending import ERROR, FAILURE, INTERRUPTED, SUCCESS
from momantu_bt.page.failures import final_failure
from momantu_bt.page.tables import value_text
from momantu_bt.record.codec import from_json
from momantu_bt.record.recording import Recording
from momantu_bt.record.text.failure import failure_line

_VERDICTS = {None: "", True: ", the referee agrees", False: ", the referee denies it"}


def about(recording: Recording) -> dict[str, Any]:
    """The head of the page: title, outcome, facts, details, and perhaps a warning."""
    told, report = recording.about, recording.report
    facts = [(name, told.get(name)) for name in ("seed", "world", "robot")]
    facts.append(("simulated", f"{_sim_time(recording):.2f} s"))
    if report is not None:
        facts.append(("wall time", f"{report['wall_time_s']:.1f} s"))
        facts.append(("fingerprint", str(report["fingerprint"])[:12]))
    details = [
        *_named("", told.get("versions", {})),
        *_named("", told.get("options", {})),
        *_named("$", told.get("values", {})),
    ]
    return {
        "title": PurePath(str(told.get("tree", recording.folder))).stem,
        "ended": None if report is None else report["status"],
        "outcome": _cut_off() if report is None else _outcome(recording, report),
        "facts": [[name, str(value)] for name, value in facts if value is not None],
        "details": details,
        "warning": "" if recording.complete else _warning(recording),
    }


def _sim_time(recording: Recording) -> float:
    """When the tree ended, s; the record goes on until everything stands still."""
    return max((tick.now for tick in recording.ticks if not tick.settling), default=0.0)


def _named(mark: str, values: Mapping[str, Any]) -> list[list[str]]:
    return [[f"{mark}{name}", value_text(from_json(value))] for name, value in values.items()]


def _cut_off() -> dict[str, str]:
    return {"kind": "cut", "words": "cut off", "sentence": ""}


def _outcome(recording: Recording, report: Mapping[str, Any]) -> dict[str, str]:
    """kind: good if the tree succeeded and no referee denies it."""
    status, success = report["status"], report["success"]
    sentence = ""
    if status == FAILURE:
        failure = final_failure(recording)
        sentence = "" if failure is None else failure_line(failure)
    elif status == ERROR:
        sentence = (report["error"] or "").strip().rpartition("\n")[2]
    elif status == SUCCESS and success is False:
        sentence = ", ".join(report["unmet"])
    verdict = "" if status in (ERROR, INTERRUPTED) else _VERDICTS[success]
    if status == FAILURE and success is not None:
        verdict = ", the referee sees success" if success else ""
    good = status == SUCCESS and success is not False
    return {"kind": "good" if good else "bad", "words": status + verdict, "sentence": sentence}


def _warning(recording: Recording) -> str:
    return (
        f"This record is cut off after {_sim_time(recording):.2f} s: the run was killed, or the "
        "file was copied while it lasted."
    )
