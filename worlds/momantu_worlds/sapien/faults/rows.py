"""The faults that a world made of bodies can have, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from types import MappingProxyType

from momantu_bt.fault import Effect, Fault, FaultError
from momantu_worlds.sapien.faults.doorway import DoorwayBlocked
from momantu_worlds.sapien.faults.kidnapped import Kidnapped
from momantu_worlds.sapien.faults.knocked_over import KnockedOver
from momantu_worlds.sapien.faults.lost import Lost
from momantu_worlds.sapien.faults.misses_object import MissesObject
from momantu_worlds.sapien.faults.moved import Moved
from momantu_worlds.sapien.faults.occupied import Occupied
from momantu_worlds.sapien.faults.person import PersonInWay
from momantu_worlds.sapien.faults.person_follows import PersonFollows
from momantu_worlds.sapien.faults.person_in_doorway import PersonInDoorway
from momantu_worlds.sapien.faults.person_reaches import PersonReaches
from momantu_worlds.sapien.faults.phantom import Phantom
from momantu_worlds.sapien.faults.removed import Removed
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tag import covered, wrong_id


@dataclass(frozen=True, slots=True)
class Row:
    """One fault. needs: what it requires of the stage."""

    make: Callable[[Stage, Fault], Effect]
    needs: tuple[Callable[[Stage], object], ...] = ()


_GOAL, _DOORWAYS, _MARKER = (attrgetter(name) for name in ("goal", "doorways", "marker"))

ROWS: Mapping[str, Row] = MappingProxyType(
    {
        "camera.misses_object": Row(MissesObject, (_GOAL,)),
        "camera.phantom": Row(Phantom, (_GOAL,)),
        "robot.kidnapped": Row(Kidnapped),
        "doorway.blocked": Row(DoorwayBlocked, (_DOORWAYS, _GOAL)),
        "person.in_way": Row(PersonInWay),
        "person.in_doorway": Row(PersonInDoorway, (_DOORWAYS, _GOAL)),
        "person.follows": Row(PersonFollows),
        "person.reaches_over": Row(PersonReaches, (_GOAL,)),
        "object.moved": Row(Moved, (_GOAL,)),
        "object.knocked_over": Row(KnockedOver, (_GOAL,)),
        "object.removed": Row(Removed, (_GOAL,)),
        "object.lost": Row(Lost, (_GOAL,)),
        "place.occupied": Row(Occupied, (_MARKER,)),
        "tag.covered": Row(covered, (_MARKER,)),
        "tag.wrong_id": Row(wrong_id, (_MARKER,)),
    }
)


def possible(stage: Stage) -> tuple[str, ...]:
    """Names of the faults that this episode can have."""
    return tuple(name for name, row in ROWS.items() if _has(stage, row))


def _has(stage: Stage, row: Row) -> bool:
    try:
        for need in row.needs:
            need(stage)
    except FaultError:
        return False
    return True


def prepare(stage: Stage, fault: Fault) -> Effect:
    """Prepare an effect that is ready to begin.

    Raises:
        FaultError: no such fault, not possible in this episode, or wrong parameters.
    """
    if fault.name not in ROWS:
        raise FaultError(f"no world fault {fault.name!r}; there are: {', '.join(ROWS)}")
    row = ROWS[fault.name]
    for need in row.needs:
        need(stage)
    return row.make(stage, fault)
