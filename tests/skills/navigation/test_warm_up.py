"""After a warm-up no drive compiles anything."""

from typing import Any

from momantu_skills.navigate import Navigate
from momantu_skills.navigation.control import graceful, guard, mppi
from momantu_skills.navigation.localize import fit, particle_filter
from momantu_skills.navigation.localize.service import LocalizationService
from momantu_skills.navigation.map import costmap
from momantu_skills.navigation.plan import planner
from momantu_skills.warm_up import compile_kernels

from momantu_bt.geometry import Pose2D
from momantu_bt.testing import run_skill
from tests.skills.scenery.flat import Flat, FlatSceneOf

KERNELS = {
    f"{module.__name__}.{name}": kernel
    for module in (graceful, costmap, fit, guard, mppi, particle_filter, planner)
    for name, kernel in vars(module).items()
    if hasattr(kernel, "signatures")
}


def _signatures() -> dict[str, list[Any]]:
    return {name: list(kernel.signatures) for name, kernel in KERNELS.items()}


def test_a_drive_needs_no_other_kernels(flat: Flat, flat_scene: FlatSceneOf) -> None:
    compile_kernels()
    before = _signatures()
    world = flat()
    services = {"localization": LocalizationService(), "planning_scene": flat_scene(world)}
    result = run_skill(Navigate, world=world, services=services, inputs={"goal": Pose2D(-1, 1, 2)})
    assert result.status == "SUCCESS", result.explain()
    assert _signatures() == before
