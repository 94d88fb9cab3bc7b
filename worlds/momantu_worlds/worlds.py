"""Worlds described by world files: cheap to import; `open` loads the simulator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from momantu_bt.errors import InputError
from momantu_bt.lazy import lazily
from momantu_bt.robot import laser_band
from momantu_bt.world import Site
from momantu_bt.world_plugins import WORLDS

with lazily():
    from momantu_worlds import simulated_world
    from momantu_worlds.scenes import loading
    from momantu_worlds.scenes.file import references, summary
    from momantu_worlds.scenes.site import maps

if TYPE_CHECKING:
    from momantu_bt.robot import RobotDescription
    from momantu_bt.world import World
    from momantu_worlds.scenes.file.world import WorldFile
    from momantu_worlds.scenes.geometry.bodies import Episode


@dataclass(frozen=True, slots=True)
class WorldOfFile:
    """A world that is described by a file: an entry of `momantu_bt.worlds`, or a user's own."""

    path: Path

    @property
    def name(self) -> str:
        """The world's name; raises as `site`."""
        return self.site().name

    @property
    def default_robot(self) -> str:
        """The robot that it is meant for: a name, or a path from here; raises as `site`."""
        robot = loading.nominal(self.path).robot
        is_path = "/" in robot or robot.endswith((".yaml", ".yml"))
        return str(self.path.parent / robot) if is_path else robot

    def site(self) -> Site:
        """The nominal site, without maps.

        Raises:
            WorldError: the world file cannot be read, or is wrong.
        """
        return loading.nominal(self.path).site

    def site_for(self, description: RobotDescription) -> Site:
        """The nominal site with the maps of a robot; raises as `site`."""
        return self._mapped(self.site(), loading.load_world(self.path), description)

    def files(self) -> tuple[Path, ...]:
        """The world file and all files that it names; raises as `site`."""
        return loading.load_world(self.path).files()

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """Draw the episode of `seed` and build it in SAPIEN.

        Raises:
            WorldError: the world file is wrong, the robot cannot be simulated, or nothing renders.
        """
        world, episode = loading.load_world(self.path), self.draw(seed)
        episode = replace(episode, site=self._mapped(episode.site, world, description))
        return simulated_world.SapienWorld(self.path, description, episode, seed, referee=referee)

    @staticmethod
    def _mapped(site: Site, world: WorldFile, description: RobotDescription) -> Site:
        return maps.with_maps(site, world, laser_band(description), description.height)

    def about(self) -> Mapping[str, Mapping[str, str]]:
        """Tags, loose objects, what varies between episodes and the goal, in words."""
        return summary.world_summary(self.path)

    def goal_names(self) -> Mapping[str, Sequence[str]]:
        """See `momantu_bt.goal.GoalNames`; raises as `site`."""
        return references.goal_names(loading.load_world(self.path))

    def draw(self, seed: int) -> Episode:
        """The episode of a seed; raises WorldError."""
        return loading.draw_episode(self.path, seed)


def world_from_file(path: Path) -> WorldOfFile:
    """The world that a file describes; the file is read later."""
    return WorldOfFile(path)


def load_world_file(name: str) -> WorldOfFile:
    """A world by its name or path, for commands that read its file.

    Raises:
        PluginError: there is no such world.
        InputError: it is not described by a world file.
    """
    entry = WORLDS.load(name)
    if not isinstance(entry, WorldOfFile):
        raise InputError(
            f"the world {name!r} is not described by a world file, which this command reads; "
            "see whether its package has a command of its own: `momantu-bt worlds --help`"
        )
    return entry


def _bundled(name: str) -> WorldOfFile:
    return WorldOfFile(Path(__file__).parent / "scenes" / f"{name}.yaml")


four_rooms = _bundled("four_rooms")
small_flat = _bundled("small_flat")
warehouse = _bundled("warehouse")
