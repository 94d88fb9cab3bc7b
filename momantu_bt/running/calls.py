"""The skills that the skills of a run call: found and checked before anything moves."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.engine.skills.calls import (
    callees,
    callees_of,
    undeclared_uses,
    undeclared_uses_text,
)
from momantu_bt.errors import MomantuError
from momantu_bt.formats.names import valid_names
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Skill
from momantu_bt.tree.registry import Registry


class CallError(MomantuError):
    """A skill declares a call that this run cannot make; nothing was started."""


def called_skills(kinds: Mapping[str, type[Skill]], registry: Registry) -> dict[str, type[Skill]]:
    """The skills that these call, also indirectly, by their names.

    Raises:
        CallError: one is not installed. PluginError: one is broken.
    """
    try:
        return callees(kinds.values(), registry.skills.__getitem__)
    except KeyError as error:
        name = str(error.args[0])
        callers = [caller for caller, kind in kinds.items() if name in kind.calls]
        hint = valid_names(name, sorted(registry.skills), "installed skills")
        who = ", ".join(callers) or "a called skill"
        raise CallError(f"{who} calls {name!r}, which is not installed; {hint}") from None


def check_calls(
    kinds: Mapping[str, type[Skill]], registry: Registry, description: RobotDescription
) -> None:
    """Check that each skill's `uses` has the actuators of those that it calls.

    Raises:
        CallError: one is missing; the message says which, and what to do.
    """
    for name, kind in kinds.items():
        for each, called in callees_of(kind, registry.skills.__getitem__).items():
            missing = undeclared_uses(kind, called, description)
            if missing:
                raise CallError(undeclared_uses_text(name, each, missing))
