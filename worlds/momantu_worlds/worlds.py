"""The worlds that this package brings; cheap to import, the simulator comes with `open`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from momantu_bt.world import Site

if TYPE_CHECKING:
    from momantu_bt.findings import Finding
    from momantu_bt.robot import RobotDescription
    from momantu_bt.world import World
    from momantu_worlds.scenes.bodies import Episode


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

    def about(self) -> Mapping[str, Mapping[str, str]]:
        """Tags, loose things, what varies and the goal, in words."""
        from momantu_worlds.scenes.about import about
        from momantu_worlds.scenes.loading import world_path

        return about(world_path(self.name))

    def check(self, description: RobotDescription, seeds: Sequence[int]) -> Sequence[Finding]:
        """All that is wrong for this robot in the episodes of these seeds; raises WorldError."""
        from momantu_worlds.checking.run import check_world
        from momantu_worlds.scenes.loading import sketch, world_path

        def draw(seed: int) -> Episode:
            return sketch(self.name, seed)

        return check_world(world_path(self.name), draw, description, seeds)

    def preview(self, description: RobotDescription, seed: int, *, view: bool = True) -> bytes:
        """A PNG of an episode; raises WorldError."""
        from momantu_worlds.preview.page import page
        from momantu_worlds.scenes.loading import sketch

        return page(sketch(self.name, seed), description, view=view)


four_rooms = WorldFile("four_rooms")
