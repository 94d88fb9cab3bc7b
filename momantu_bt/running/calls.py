"""The skills that the skills of a run call: found and checked before anything moves."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.errors import MomantuError
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Skill
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.skill_calls import callees, wrong_calls


class CallError(MomantuError):
    """A skill declares a call that this run cannot make; nothing was started."""


def called_skills(kinds: Mapping[str, type[Skill]], registry: Registry) -> dict[str, type[Skill]]:
    """The skills that these call, also indirectly, by their names.

    Raises:
        CallError: one is not installed. PluginError: one is broken.
    """
    check_calls(kinds, registry, None)
    try:
        return callees(kinds.values(), registry.skills.__getitem__)
    except KeyError as error:
        raise CallError(f"a called skill calls {error}, which is not installed") from None


def check_calls(
    kinds: Mapping[str, type[Skill]], registry: Registry, description: RobotDescription | None
) -> None:
    """Check that each call is to an installed skill, and that `uses` has its actuators.

    Raises:
        CallError: the first that is wrong; the message says what to do.
    """
    for name, kind in kinds.items():
        for sentence in wrong_calls(name, kind, registry.skills, description):
            raise CallError(sentence)
