"""The registry: the skills, worlds, robots and services that a tree can name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.robot import RobotDescription
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.skill import Skill
from momantu_bt.tree.plugins import SERVICES, SKILLS
from momantu_bt.world import Site, WorldEntry
from momantu_bt.world_plugins import WORLDS


@dataclass(frozen=True, slots=True)
class Registry:
    """The plug-ins that one check or run works with.

    skills: Skill classes by name. worlds: WorldEntry by name. robots: functions that give a
    RobotDescription, by name. services: by the names that trees read as `$@name`.
    """

    skills: Mapping[str, type[Skill]] = field(default_factory=dict)
    worlds: Mapping[str, WorldEntry] = field(default_factory=dict)
    robots: Mapping[str, Any] = field(default_factory=dict)
    services: Mapping[str, Any] = field(default_factory=dict)
    _described: dict[str, RobotDescription] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @classmethod
    def installed(cls) -> Registry:
        """Everything found by entry points."""
        return cls(SKILLS, WORLDS, ROBOTS, SERVICES)

    def site(self, world: str) -> Site:
        """The nominal site of a world; KeyError if there is no such world."""
        return self.worlds[world].site()

    def description(self, robot: str) -> RobotDescription:
        """A robot's description, read once; KeyError if there is no such robot."""
        if robot not in self._described:
            self._described[robot] = self.robots[robot]()
        return self._described[robot]
