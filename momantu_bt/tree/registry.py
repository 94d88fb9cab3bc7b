"""What a tree can name: skills, worlds, robots and services; installed ones, or a test's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt import plugins
from momantu_bt.plugin_files import by_path
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Skill
from momantu_bt.world import Site, WorldEntry


class Plugins(Mapping[str, Any]):
    """The plug-ins of one entry point group; each is imported and checked when it is asked for.

    Robots and worlds are had by the paths of their files, too.

    Looking one up raises PluginError when it is broken, KeyError when there is none.
    """

    def __init__(self, group: str) -> None:
        self._group = group

    def __getitem__(self, name: str) -> Any:
        if name not in self:
            raise KeyError(name)
        return plugins.load(self._group, name)

    def __iter__(self) -> Iterator[str]:
        return iter(plugins.installed(self._group))

    def __len__(self) -> int:
        return len(plugins.installed(self._group))

    def __contains__(self, name: object) -> bool:
        named_by_file = isinstance(name, str) and by_path(self._group, name)
        return named_by_file or name in plugins.installed(self._group)


@dataclass(frozen=True, slots=True)
class Registry:
    """The plug-ins that one check or run works with.

    skills: Skill classes by name. worlds: WorldEntry by name. robots: functions that give a
    RobotDescription, by name. services: anything, by the names that trees read as `$@name`.
    """

    skills: Mapping[str, type[Skill]] = field(default_factory=dict)
    worlds: Mapping[str, WorldEntry] = field(default_factory=dict)
    robots: Mapping[str, Any] = field(default_factory=dict)
    services: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def installed(cls) -> Registry:
        """Everything found by entry points."""
        return cls(
            Plugins(plugins.SKILLS),
            Plugins(plugins.WORLDS),
            Plugins(plugins.ROBOTS),
            Plugins(plugins.SERVICES),
        )

    def site(self, world: str) -> Site:
        """The nominal site of a world; KeyError when there is none of that name."""
        return self.worlds[world].site()

    def description(self, robot: str) -> RobotDescription:
        """A robot's description; KeyError when there is none of that name."""
        found: RobotDescription = self.robots[robot]()
        return found
