"""Skills and services by name: the plug-ins that trees can name."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from momantu_bt.plugins import Group
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.tree.skill_objection import skill_objection
from momantu_bt.values.kinds import is_type

ROBOT = "robot"
"""The key `$@robot`, which every run publishes; no service can have its name."""

SKILLS: Group[type[Skill]] = Group("momantu_bt.skills", "skill", skill_objection)


_NAME = re.compile(r"[^\W\d]\w*")


def bad_service_name(name: str) -> str | None:
    """Why a service cannot have this name, which trees write as `$@name`; None if it can."""
    if not _NAME.fullmatch(name):
        return f"{name!r} is not a name for a service: letters, digits and underscores"
    if name == ROBOT:
        return f"{name!r} is a key that every run publishes; give the entry point another name"
    return None


def service_objection(name: str, plugin: Any) -> str | None:
    """Why runs cannot use a plug-in as a service; None if they can."""
    if not (isinstance(plugin, type) and issubclass(plugin, Service)):
        kind = plugin.__name__ if isinstance(plugin, type) else type(plugin).__name__
        return f"{kind} is not a subclass of momantu_bt.Service"
    said = plugin.__name__
    if bad_service_name(name) is not None:
        return bad_service_name(name)
    for method in ("start", "update"):
        if getattr(plugin, method) is getattr(Service, method):
            return f"{said} has no {method}: see momantu_bt.Service"
    if not isinstance(plugin.rate, int | float) or not 0.0 < plugin.rate < math.inf:
        return f"{said}.rate is {plugin.rate!r}; expected updates per second, above 0"
    if not isinstance(plugin.publishes, Mapping):
        return f"{said}.publishes is not a mapping of keys to types, such as {{'charge': float}}"
    for key, type_ in plugin.publishes.items():
        if not isinstance(key, str) or not _NAME.fullmatch(key):
            return f"{said}.publishes: {key!r} is not a key: letters, digits and underscores"
        if not is_type(type_):
            return f"{said}.publishes: {type_!r} of {key!r} is not a type"
    if plugin.publishes and plugin.published is Service.published:
        return f"{said} declares keys in `publishes` and has no published()"
    listed = {name: getattr(plugin, name) for name in ("needs", "senses", "replaces")}
    return next(filter(None, (_names(said, name, value) for name, value in listed.items())), None)


def _names(said: str, what: str, value: Any) -> str | None:
    if isinstance(value, str) or not all(isinstance(each, str) for each in value):
        return f"{said}.{what} is {value!r}; expected a tuple of names, such as ('laser',)"
    return None


SERVICES: Group[type[Service]] = Group("momantu_bt.services", "service", service_objection)
