"""Skills and services by name: the plug-ins that trees can name."""

from __future__ import annotations

from typing import Any

from momantu_bt.plugins import Group
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.tree.skill_objection import skill_objection

SKILLS: Group[type[Skill]] = Group("momantu_bt.skills", "skill", skill_objection)


def _service(name: str, plugin: Any) -> str | None:
    if isinstance(plugin, type) and issubclass(plugin, Service):
        return None
    return f"{plugin!r} is not a subclass of momantu_bt.Service"


SERVICES: Group[type[Service]] = Group("momantu_bt.services", "service", _service)
