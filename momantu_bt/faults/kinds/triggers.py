"""Find the usual phases of a kind of fault, given the installed skills."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import get_args

from momantu_bt.activity import Activity
from momantu_bt.fault_kind import Trigger
from momantu_bt.messages import DetectedObject, SupportPlane
from momantu_bt.robot import ARM
from momantu_bt.skill import Port, Skill

_USING: Mapping[str, Activity] = MappingProxyType(
    {"base": Activity.DRIVE, ARM: Activity.MOVE_ARM, "gripper": Activity.GRASP}
)
_GIVING: Mapping[type, Activity] = MappingProxyType(
    {DetectedObject: Activity.FIND_OBJECT, SupportPlane: Activity.MEASURE_SURFACE}
)


def usual_phases(triggers: Iterable[Trigger], skills: Mapping[str, type[Skill]]) -> Iterator[str]:
    """The phases that triggers mean, in order; skills: by name, in the order of the tree."""
    for trigger in triggers:
        for name, skill in skills.items():
            behind = activities_of(skill).get(trigger.activity)
            if behind is not None:
                yield trigger.phase(name, behind)


def activities_of(skill: type[Skill]) -> Mapping[Activity, str]:
    """A skill's activities, as it declares them, or else from its `uses` and its outputs.

    A written phase has the value behind the skill's name.
    """
    found = dict(_seeming(skill) if skill.activities is None else skill.activities)
    found[Activity.ANY] = ""
    if _outputs(skill):
        found[Activity.ANSWER] = ""
    return found


def _seeming(skill: type[Skill]) -> Iterator[tuple[Activity, str]]:
    for use, activity in _USING.items():
        if use in skill.uses:
            yield activity, ""
    given = {type_ for port in _outputs(skill) for type_ in (port.type, *get_args(port.type))}
    for kind, activity in _GIVING.items():
        if kind in given:
            yield activity, ""
    if given:
        yield Activity.LOOK, ""


def _outputs(skill: type[Skill]) -> list[Port]:
    return [port for port in skill.ports.values() if port.direction == "out"]
