"""The rules that a skill class must keep; checked after it has been imported."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from momantu_bt.activity import Activity
from momantu_bt.failure import CODE
from momantu_bt.skill import Port, Skill
from momantu_bt.symptom import Symptom
from momantu_bt.tree.catalogue import MODIFIERS, NODES, SPELLED
from momantu_bt.tree.catalogue.built_in import BUILT_IN
from momantu_bt.tree.catalogue.objection import unusable_name
from momantu_bt.values.kinds import is_type

_DECLARED = tuple(each for each in Activity if each not in (Activity.ANY, Activity.ANSWER))


def bad_skill_name(name: str) -> str | None:
    """Why a skill cannot have this name; None if it can."""
    taken = SPELLED.get(name) or NODES.get(name)
    if taken is not None:
        whose = "a built-in node" if taken.type in BUILT_IN else "the node of another package"
        return f"{name!r} is {whose}; give the entry point another name"
    if name in MODIFIERS:
        return f"{name!r} is a modifier of nodes; give the entry point another name"
    return unusable_name(name, "a skill")


def skill_objection(name: str, plugin: Any) -> str | None:
    """Why trees cannot use a plug-in as a skill; None if they can."""
    if not (isinstance(plugin, type) and issubclass(plugin, Skill)):
        kind = plugin.__name__ if isinstance(plugin, type) else type(plugin).__name__
        return f"{kind} is not a subclass of momantu_bt.Skill"
    unfit = bad_skill_name(name)
    if unfit is not None:
        return unfit
    if plugin.run is Skill.run:
        return f"{plugin.__name__} has no run(self, robot)"
    if not _own_doc(plugin):
        return f"{plugin.__name__} has no docstring: one sentence that says what it does"
    for port in plugin.ports.values():
        wrong = _port(plugin, port)
        if wrong is not None:
            return wrong
    return _failures(plugin) or _uses(plugin) or _activities(plugin) or _symptoms(plugin)


def _own_doc(kind: type[Skill]) -> bool:
    """Whether the class, or a base class other than Skill, has a docstring."""
    above = kind.__mro__[: kind.__mro__.index(Skill)]
    return any((vars(each).get("__doc__") or "").strip() for each in above)


def _port(kind: type[Skill], port: Port) -> str | None:
    said = f"the port {kind.__name__}.{port.name}"
    if not isinstance(port.doc, str) or not port.doc.strip():
        return f"{said} has no doc: write {'In' if port.direction == 'in' else 'Out'}(doc=…)"
    if port.type is None or not is_type(port.type):
        return f"{said} has no type: {port.type!r} is not a type"
    return None


def _failures(kind: type[Skill]) -> str | None:
    if not isinstance(kind.failures, Mapping):
        return f"{kind.__name__}.failures is not a mapping of codes to sentences"
    for code, sentence in kind.failures.items():
        if not isinstance(code, str) or not CODE.fullmatch(code):
            return f"{kind.__name__}.failures: {code!r} is not a code: UPPER_CASE words"
        if not isinstance(sentence, str) or not sentence.strip():
            return f"{kind.__name__}.failures: no sentence explains {code}"
    return None


def _uses(kind: type[Skill]) -> str | None:
    for name, what in (("uses", "actuators' names"), ("senses", "kinds of sensors")):
        value = getattr(kind, name)
        if not isinstance(value, set | frozenset) or not all(isinstance(u, str) for u in value):
            return f"{kind.__name__}.{name} is not a set of {what}"
    return None


def _activities(kind: type[Skill]) -> str | None:
    if kind.activities is None:
        return None
    said = f"{kind.__name__}.activities"
    if not isinstance(kind.activities, Mapping):
        return f"{said} is not a mapping, such as {{Activity.DRIVE: ''}}"
    for activity, behind in kind.activities.items():
        if activity not in _DECLARED:
            valid = ", ".join(f"Activity.{each.name}" for each in _DECLARED)
            return f"{said}: {activity!r} is not an activity that a skill declares; valid: {valid}"
        if not isinstance(behind, str) or behind[:1] not in ("", "/", "+"):
            return f"{said}: {behind!r} is not '', '/PHASE' or '+3 s'"
    return None


def _symptoms(kind: type[Skill]) -> str | None:
    if kind.symptoms is None:
        return None
    said = f"{kind.__name__}.symptoms"
    if not isinstance(kind.symptoms, Mapping):
        return f"{said} is not a mapping of codes to sets of Symptom"
    for code, symptoms in kind.symptoms.items():
        if code not in kind.failures:
            return f"{said}: {code!r} is not among its failures: {', '.join(kind.failures)}"
        if not isinstance(symptoms, set | frozenset) or not symptoms <= set(Symptom):
            return f"{said}: {code} has {symptoms!r}; expected a set of Symptom"
    return None
