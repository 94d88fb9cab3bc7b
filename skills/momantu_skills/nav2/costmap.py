"""ClearEntireCostmap and its kin: forget what the sensors have seen, so that it is seen anew.

Nav2 has a local and a global costmap; here there is one, so `service_name` does not matter.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.skill import Failure, In, Needs, Run, Skill
from momantu_skills.nav2.goals import Goal, pose_at
from momantu_skills.nav2.service import Nav2Service

LAYERS = ("obstacle_layer", "voxel_layer", "stvl_layer", "laser", "depth")
"""Names of layers that are cleared, all together."""


class _Clearing(Skill):
    """Clears the costmap that Nav2's leaves share."""

    failures: ClassVar = {"UNKNOWN_LAYER": "the costmap has no layer of this name"}
    symptoms: ClassVar = {}

    service_name: str | None = In(None, ignored=True, doc="Nav2's service")
    server_timeout: int | None = In(None, ignored=True, doc="ms that Nav2 waits for the service")
    plugins: tuple[str, ...] | None = In(None, doc="names of layers; obstacle_layer is all of them")

    nav2: Nav2Service = Needs("nav2_servers")
    localization: Localization = Needs()

    def run(self, robot: Robot) -> Run:
        """Clear, at once."""
        wrong = [name for name in self.plugins or () if name not in LAYERS]
        if wrong:
            raise Failure("UNKNOWN_LAYER", f"no layer {wrong[0]!r}; layers: {', '.join(LAYERS)}")
        self.clear(robot)
        return
        yield ""

    def clear(self, robot: Robot) -> None:
        """Clear the cells."""
        raise NotImplementedError


class ClearEntireCostmap(_Clearing):
    """Forget all obstacles that the sensors have seen; the map's own remain."""

    def clear(self, robot: Robot) -> None:
        """Clear all cells."""
        self.nav2.costmap.clear()


class ClearCostmapExceptRegion(_Clearing):
    """Forget the obstacles outside a square around the robot."""

    reset_distance: float = In(1.0, unit="m", least=0, doc="edge of the square")

    def clear(self, robot: Robot) -> None:
        """Clear the cells outside."""
        here, costmap = self.localization.map_from_base, self.nav2.costmap
        costmap.clear(~costmap.square(here.x, here.y, self.reset_distance))


class ClearCostmapAroundRobot(_Clearing):
    """Forget the obstacles in a square around the robot."""

    reset_distance: float = In(1.0, unit="m", least=0, doc="edge of the square")

    def clear(self, robot: Robot) -> None:
        """Clear the cells inside."""
        here, costmap = self.localization.map_from_base, self.nav2.costmap
        costmap.clear(costmap.square(here.x, here.y, self.reset_distance))


class ClearCostmapAroundPose(_Clearing):
    """Forget the obstacles near a pose."""

    failures: ClassVar = {**_Clearing.failures, "BAD_GOAL": "it is neither a pose nor a place"}

    pose: Goal = In(names="spot", doc="a pose of the map, or a place")
    reset_distance: float = In(1.0, unit="m", least=0, doc="distance from the pose")

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A pose ahead of the robot."""
        return {"inputs": {"pose": Pose2D(0.5, 0.0, 0.0)}}

    def clear(self, robot: Robot) -> None:
        """Clear the cells nearby."""
        pose = pose_at(self.pose, self.site, robot.description.working)
        costmap = self.nav2.costmap
        rows, columns = np.indices(costmap.known.shape)
        x = costmap.frame[0] + (columns + 0.5) * costmap.frame[2] - pose.x
        y = costmap.frame[1] + (rows + 0.5) * costmap.frame[2] - pose.y
        costmap.clear(np.hypot(x, y) <= self.reset_distance)
