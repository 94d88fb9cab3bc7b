"""Print the kinds of faults: a list, a page for each, and the table of the documentation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from momantu_bt.activity import Activity
from momantu_bt.fault_kind import FaultKind
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.kinds.reasons import installed_skills
from momantu_bt.faults.kinds.triggers import usual_phases
from momantu_bt.faults.matrix import ENDED, RECOVERED, Row, rows
from momantu_bt.faults.phase import START
from momantu_bt.skill import Port
from momantu_bt.symptom import Symptom
from momantu_bt.values.types import label

_PLACES = {
    "robot": "at the robot's boundary, with any robot and world",
    "site": "in what the robot is told, from the start on",
    "world": "in the surroundings, where the world can make it",
    "skill": "in a skill of the tree",
    "process": "in the process",
}
_FIRST = {Activity.ANY: "the first skill", Activity.ANSWER: "the first skill with outputs"}


def as_text(kind: FaultKind) -> str:
    """All that is known of a kind."""
    lines = [f"{kind.name}: {kind.doc}", "", f"Where     {_PLACES[kind.place]}"]
    lines.append(f"Begins    {_phases(kind)}, unless @PHASE says when")
    for number, row in enumerate(_rows(kind)):
        lines += ["", row.fault] if number else [""]
        lines.append(f"Recover   {_can(row)}")
        lines.append(f"Notice    within {row.notice:g} s")
        lines.append(f"Must end  {_ending(row)}")
    if kind.parameters:
        lines += ["", "Parameters", *(f"  {_parameter(port)}" for port in kind.parameters)]
    lines += ["", "Example", f"  momantu-bt run bring_object --fault {_example(kind)}"]
    return "\n".join(lines)


def as_data(kind: FaultKind) -> dict[str, Any]:
    """The same for programs."""
    return {
        "name": kind.name,
        "doc": kind.doc,
        "place": kind.place.value,
        "phases": list(_usual(kind)) or [START],
        "notice_s": kind.notice,
        "reasons": sorted(Row(kind.name, kind, kind.recoverable).reasons),
        "rows": [{"fault": row.fault, "recoverable": row.recoverable} for row in _rows(kind)],
        "parameters": [
            {
                "name": port.name,
                "type": label(port.type),
                "unit": port.unit,
                "default": "inf" if port.default == math.inf else port.default,
                "least": port.least,
                "most": port.most,
                "doc": port.doc,
            }
            for port in kind.parameters
        ],
    }


def as_table() -> str:
    """Every row in Markdown."""
    head = ("fault", "what happens", "recover?", "notice within", "must end", "true reasons")
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for row in rows():
        first = row.fault == row.kind.name
        doc, codes = (row.kind.doc, ", ".join(sorted(row.reasons))) if first else ("", "as above")
        notice, end = f"{row.notice:g} s", _short_ending(row)
        cells = (f"`{row.fault}`", doc, _can(row), notice, end, codes)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def as_parameters() -> str:
    """Every kind's parameters and usual phases in Markdown."""
    lines = ["| fault | begins | parameters |", "|---|---|---|"]
    for kind in kinds().values():
        parameters = "<br>".join(_parameter(port) for port in kind.parameters)
        lines.append(f"| `{kind.name}` | {_phases(kind)} | {parameters} |")
    return "\n".join(lines)


def as_words() -> str:
    """The activities and symptoms that skills can declare, in Markdown."""
    lines = ["| activity | what the skill does |", "|---|---|"]
    lines += [f"| `{each.name}` | {each.value} |" for each in Activity if each not in _FIRST]
    lines += ["", "| symptom | what is wrong |", "|---|---|"]
    return "\n".join([*lines, *(f"| `{each.name}` | {each.value} |" for each in Symptom)])


def _rows(kind: FaultKind) -> Iterator[Row]:
    return (row for row in rows() if row.kind is kind)


def _can(row: Row) -> str:
    return "yes" if row.recoverable else "no"


def _ending(row: Row) -> str:
    if row.kind.ends_process:
        return "the process ends, the robot stands"
    codes = ", ".join(sorted(row.reasons))
    return f"recovered, else {codes}" if row.recoverable else codes


def _short_ending(row: Row) -> str:
    if row.must_end in (RECOVERED, ENDED):
        return str(row.must_end)
    return "with a true reason"


def _phases(kind: FaultKind) -> str:
    return ", else ".join((*_usual(kind), START))


def _usual(kind: FaultKind) -> Iterator[str]:
    """Its usual phases, with the installed skills."""
    for moment in kind.begins:
        if moment.activity in _FIRST:
            yield _FIRST[moment.activity]
        else:
            yield from usual_phases((moment,), installed_skills())


def _parameter(port: Port) -> str:
    value = _value(port)
    default = f"{value} {port.unit}" if port.unit and value != "inf" else f"{value}"
    bounds = f"; {port.bounds}" if port.bounded else ""
    return f"{port.name} ({default or 'none'}{bounds}): {port.doc}"


def _value(port: Port) -> Any:
    if isinstance(port.default, float):
        return "inf" if math.isinf(port.default) else f"{port.default:g}"
    return port.default


def _example(kind: FaultKind) -> str:
    phase = next((text for text in _usual(kind) if text not in _FIRST.values()), None)
    given = f":{kind.parameters[0].name}={_value(kind.parameters[0])}" if kind.parameters else ""
    return f'"{kind.name}{"" if phase is None else "@" + phase}{given}"'
