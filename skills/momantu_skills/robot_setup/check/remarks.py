"""What is found wrong with a robot, before its place in the file is known."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from momantu_bt.descriptions.reading import Place, Reading, read_text
from momantu_bt.findings import Finding, Severity, in_order
from momantu_bt.robot import RobotDescription
from momantu_bt.robots import RobotFileError


@dataclass(frozen=True)
class Remark:
    """A finding at a place of the robot file, given by its keys; see `Finding`."""

    severity: Severity
    code: str
    message: str
    cure: str
    place: Place


def located(description: RobotDescription, remarks: Iterable[Remark]) -> list[Finding]:
    """The findings, each at its line of the robot file, in order."""
    source = description.source
    reading = None
    if source is not None:
        reading = Reading(source, read_text(source, RobotFileError), RobotFileError)
    found = []
    for remark in remarks:
        line, column = (0, 0) if reading is None else reading.at(remark.place, key=True)
        found.append(
            Finding(remark.severity, remark.code, remark.message, remark.cure, source, line, column)
        )
    return in_order(found)
