"""find_surface: a table that stands elsewhere is found, and no other one is taken for it."""

import math
from collections.abc import Sequence
from typing import Any

import pytest
from momantu_skills.find_surface import FindSurface
from momantu_skills.navigation.localize.service import LocalizationService

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.testing import ScriptedRobot, small_robot
from momantu_bt.testing.painting import Block, Painter
from momantu_bt.testing.skill_run import SkillResult, run_skill
from momantu_bt.world import Surface
from tests.skills.scenery.flat import Flat, FlatScene
from tests.skills.scenery.table import SceneOf

BEGIN = Pose2D(1.9, 0.2, 0.0)
"""In the room of the desk, before the place where it is said to be."""
SIZE = (0.6, 1.2)


class Scene(FlatScene):
    """Notes what was found."""

    def __init__(self, outline: Any) -> None:
        super().__init__(outline)
        self.found: dict[str, Surface] = {}

    def observe(self, snapshot: Any) -> None:
        """Pictures are not needed here."""

    def surface_found(self, name: str, surface: Surface) -> None:
        self.found[name] = surface


def top(x: float, y: float, yaw: float = 0.0, size: Any = SIZE, height: float = 0.7) -> Block:
    """A board at a pose of the map, as the painter places it: in odom."""
    odom_from_map = BEGIN.inverse()
    at = odom_from_map @ Pose2D(x, y, yaw)
    return Block((*size, 0.04), (at.x, at.y, height - 0.02), at.yaw)


def search(flat: Flat, tops: Sequence[Block], **more: Any) -> tuple[SkillResult, Scene]:
    description = small_robot()
    camera = description.sensors["camera"].model_copy(update={"width": 320, "height": 240})
    description = description.model_copy(
        update={"sensors": {**description.sensors, "camera": camera}}
    )
    world = flat(BEGIN, drift=0.0, description=description, **more)
    world.robot.readings["camera"] = Painter(tops)
    scene = Scene(description.footprint)
    services = {"localization": LocalizationService(), "planning_scene": scene}
    result = run_skill(
        FindSurface,
        world=world,
        services=services,
        inputs={"surface": "desk"},
        max_time=200.0,
    )
    return result, scene


@pytest.mark.parametrize(
    ("x", "y", "yaw"),
    [(3.5, -0.5, 0.0), (3.6, 0.9, 0.4)],
)
def test_a_moved_table_is_found_and_believed(flat: Flat, x: float, y: float, yaw: float) -> None:
    result, scene = search(flat, [top(x, y, yaw)])
    assert result.status == "SUCCESS", result.explain()
    at = scene.found["desk"].map_from_surface
    assert at.distance_to(Pose2D(x, y)) < 0.06
    assert abs(at.yaw - yaw) < 0.06
    assert scene.found["desk"].height == pytest.approx(0.7, abs=0.02)
    assert result.outputs["moved"] == pytest.approx(math.hypot(x - 3.9, y - 0.2), abs=0.06)
    assert result.outputs["top"].frame == "map"
    assert result.robot.nearest > 0.0  # type: ignore[attr-defined]


def test_of_two_like_it_the_nearer_one_is_taken(flat: Flat) -> None:
    result, scene = search(flat, [top(3.6, 1.5), top(3.7, -0.4)])
    assert result.status == "SUCCESS", result.explain()
    assert scene.found["desk"].map_from_surface.distance_to(Pose2D(3.7, -0.4)) < 0.06


def test_a_table_of_another_size_is_not_it(flat: Flat) -> None:
    result, scene = search(flat, [top(3.7, 0.0, size=(1.2, 1.8))])
    assert result.failure is not None
    assert result.failure.code == "SURFACE_NOT_FOUND"
    assert "larger" in result.failure.message
    assert "looked from (1.9, 0.2)" in result.failure.message
    assert len(result.failure.data["looked_from"]) >= 2
    assert not scene.found


def test_one_that_the_map_knows_is_another_one(flat: Flat) -> None:
    result, scene = search(flat, [top(3.9, 1.5)], known=[(3.6, 0.9, 4.2, 2.1)])
    assert result.failure is not None
    assert "on the map as something else" in result.failure.message
    assert not scene.found


def test_where_there_is_none_it_says_from_where_it_looked(flat: Flat) -> None:
    result, _ = search(flat, [])
    assert result.failure is not None
    assert result.failure.code == "SURFACE_NOT_FOUND"
    assert "no level top" in result.failure.message
    assert "(3.90, 0.20)" in result.failure.message
    assert len(result.failure.data["looked_from"]) <= 5


def test_an_unknown_surface_names_those_there_are(flat: Flat) -> None:
    world = flat(BEGIN)
    services = {"localization": LocalizationService(), "planning_scene": Scene([(0.1, 0.1)] * 3)}
    result = run_skill(FindSurface, world=world, services=services, inputs={"surface": "dask"})
    assert result.failure is not None
    assert "surfaces: desk" in result.failure.message


def test_not_localized(flat: Flat) -> None:
    """Told to be in a cupboard's corner of the other room, the scans fit nothing near."""
    world = flat(Pose2D(-2.0, 0.0, 0.0), believed=Pose2D(5.4, -2.4, 2.0))
    services = {
        "localization": LocalizationService(),
        "planning_scene": Scene(world.robot.description.footprint),
    }
    result = run_skill(
        FindSurface, world=world, services=services, inputs={"surface": "desk"}, max_time=60.0
    )
    assert result.code == "NOT_LOCALIZED", result.explain()
    assert world.robot.truth == Pose2D(-2.0, 0.0, 0.0)


def test_it_does_not_drive_with_an_arm_stretched_out_that_does_not_fold(
    stretched_out: ScriptedRobot, scene_of: SceneOf
) -> None:
    scene = scene_of(stretched_out)
    result = run_skill(
        FindSurface,
        robot=stretched_out,
        inputs={"surface": "table_a"},
        services={"localization": object(), "planning_scene": scene},
        frames=scene.frames,
    )
    assert result.code == "ARM_STUCK", result.explain()
    assert all(actuator != "base" for _, actuator, goal in stretched_out.commands if goal)


def test_transforms_agree() -> None:
    """The painter's boards lie where the map has them."""
    block = top(3.9, 0.2)
    assert (BEGIN.transform() @ Transform(block.centre)).position[:2] == pytest.approx((3.9, 0.2))
