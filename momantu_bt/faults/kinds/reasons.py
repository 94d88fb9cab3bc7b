"""The failure codes that count as true reasons of a fault."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint

from momantu_bt.fault_kind import FaultKind, Where
from momantu_bt.plugins import PluginError
from momantu_bt.skill import Skill
from momantu_bt.tree.plugins import SKILLS

_OF_THE_RUN = (Where.SKILL, Where.PROCESS)


def true_reasons(kind: FaultKind, skills: Iterable[type[Skill]]) -> frozenset[str]:
    """The engine's codes that the kind names, and the skills' codes that share its symptoms."""
    return kind.codes.union(*(_codes(kind, skill) for skill in skills))


def _codes(kind: FaultKind, skill: type[Skill]) -> frozenset[str]:
    if skill.symptoms is None:
        return frozenset(skill.failures) if _may_hit(kind, skill) else frozenset()
    return frozenset(c for c, symptoms in skill.symptoms.items() if kind.symptoms & symptoms)


def _may_hit(kind: FaultKind, skill: type[Skill]) -> bool:
    """Whether a fault may make a skill fail that declares no symptoms for its failures.

    An actuator's fault hits the skills that use the actuator. Skills do not declare what they sense
    and are told, so a fault of those may hit any skill. A fault of the software may hit any skill
    if the fault has symptoms.
    """
    if kind.actuator:
        return kind.actuator in skill.uses
    return bool(kind.symptoms) or kind.place not in _OF_THE_RUN


def installed_skills() -> Mapping[str, type[Skill]]:
    """All skills that can be loaded, by name."""
    return _loaded(tuple(SKILLS.installed().values()))


@cache
def _loaded(entries: tuple[EntryPoint, ...]) -> Mapping[str, type[Skill]]:
    return dict(_each(entries))


def _each(entries: Iterable[EntryPoint]) -> Iterator[tuple[str, type[Skill]]]:
    for entry in entries:
        try:
            yield entry.name, SKILLS.load(entry.name)
        except PluginError:  # `momantu-bt doctor` says why
            continue
