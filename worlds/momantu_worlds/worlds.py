"""The worlds that this package brings; cheap to import, the simulator comes with `open`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from momantu_bt.world import Site

if TYPE_CHECKING:
    from momantu_bt.robot import RobotDescription
    from momantu_bt.world import World


@dataclass(frozen=True, slots=True)
class WorldFile:
    """An entry of `momantu_bt.worlds` that is described by a world file of its name."""

    name: str
    default_robot: str = "fetch"

    def site(self) -> Site:
        """The nominal site, read from the world file alone."""
        from momantu_worlds.scenes.loading import nominal_site

        return nominal_site(self.name)

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """Draw the episode of `seed` and build it in SAPIEN.

        Raises:
            WorldError: the world file is wrong, the robot cannot be simulated, or nothing renders.
        """
        from momantu_worlds.sapien.world import SapienWorld
        from momantu_worlds.scenes.loading import draw_episode

        episode = draw_episode(self.name, seed)
        return SapienWorld(self.name, description, episode, seed, referee=referee)


four_rooms = WorldFile("four_rooms")
