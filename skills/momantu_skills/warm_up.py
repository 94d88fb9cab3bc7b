"""Compile all numba kernels once, so that no run waits for it: half a minute on one core.

`python -m momantu_skills.warm_up` returns quickly if the compiled kernels exist already.
"""

from __future__ import annotations

import numpy as np

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Pose2D
from momantu_bt.robot import BaseKind, BaseLimits
from momantu_skills.manipulation.model import group
from momantu_skills.navigation.config import LocalizationConfig, NavigationConfig
from momantu_skills.navigation.control import glide, graceful
from momantu_skills.navigation.control.guard import safe_share
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.localize.localizer import Localizer
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.plan.planner import plan
from momantu_skills.perception.learned import similarity


def compile_kernels() -> None:
    """Compile the kernels of arm and base into numba's cache."""
    group.compile_kernels()
    compile_navigation()
    compile_perception()


def compile_navigation() -> None:
    """Call every navigation kernel with the argument types that are used on the robot."""
    cells = np.zeros((60, 60), np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    cells.setflags(write=False)
    grid = GridMap(cells, 0.05, (0.0, 0.0))
    config = NavigationConfig()
    limits = BaseLimits(linear=1.0, angular=1.0, linear_acceleration=1.0, angular_acceleration=1.0)
    gliding = limits.model_copy(update={"kind": BaseKind.OMNIDIRECTIONAL})
    here, goal, disc = Pose2D(1.0, 1.0), Pose2D(2.0, 1.5), np.array([[0.0, 0.0, 0.2]])
    ways = np.array([[1.0, 0.0], [0.0, 1.0]])
    rays = Rays(np.zeros(2), ways, np.array([1.9, 1.9]), np.ones(2, np.bool_))
    costmap = Costmap(grid, None, config)
    costmap.see_laser(here, rays)
    costmap.room(here, disc)
    random = np.random.default_rng(0)
    localizer = Localizer(grid, LocalizationConfig(), random)
    localizer.reset(here, 0.1, 0.1)
    localizer.observe(rays)
    way = plan(costmap, here, goal, 0.25, config.comfort, config.planner)
    if way is not None:
        Mppi(limits, config, random).command(here, (0.0, 0.0, 0.0), costmap, disc, way)
        Mppi(gliding, config, random).command(here, (0.0, 0.0, 0.0), costmap, disc, way)
    graceful.simulate(here, (0.0, 0.0, 0.0), goal, limits, costmap, disc)
    glide.simulate(here, (0.0, 0.0, 0.0), goal, gliding, costmap, disc)
    glide.command(here, goal, gliding)
    graceful.command(here, goal, limits)
    safe_share((0.5, 0.1, 0.0), (0.0, 0.0, 0.0), limits, disc, rays.points())


def compile_perception() -> None:
    """Call the learned detector's kernels, which need no network."""
    random = np.random.default_rng(0)
    points = random.random((40, 3))
    similarity.fit(points, points, 0.01, (0.5, 2.0), random)


if __name__ == "__main__":
    compile_kernels()
