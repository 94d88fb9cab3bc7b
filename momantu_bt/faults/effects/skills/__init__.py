"""Faults of skills: any skill, in a class around its class."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from momantu_bt.fault import Fault
from momantu_bt.faults.effects.skills import modes
from momantu_bt.faults.effects.skills.victim import SkillFault

MODES: Mapping[str, type[SkillFault]] = MappingProxyType(
    {
        "skill.exception": modes.Raises,
        "skill.hang": modes.Hangs,
        "skill.hang_native": modes.HangsInNativeCode,
        "skill.nan": modes.NotANumber,
        "skill.wrong_type": modes.WrongType,
        "skill.slow": modes.Slow,
    }
)
"""By the fault's name."""


def skill_fault(fault: Fault) -> SkillFault:
    """The effect of a fault; its method `wrapped` puts it into a tree's skills."""
    return MODES[fault.name](fault)
