"""The room for any skill: its map, its camera and its laser tell of the same things."""

from __future__ import annotations

from enum import Enum
from typing import Literal

import numpy as np
import pytest

from momantu_bt.geometry import Pose, Pose2D
from momantu_bt.messages import DetectedObject, JointPositions, ObjectClass, SupportPlane
from momantu_bt.robot import read_camera, read_laser
from momantu_bt.skill import In, Skill
from momantu_bt.testing import ExampleWorld, ScriptedRobot, small_robot
from momantu_bt.testing.example_inputs import NoExample, example_inputs
from momantu_bt.testing.example_world import HALF, RESOLUTION


class Colour(Enum):
    RED = "red"


class EveryType(Skill):
    """Takes a value of each type."""

    number: float = In(unit="m", doc="a")
    count: int = In(doc="a")
    flag: bool = In(doc="a")
    text: str = In(doc="a")
    colour: Colour = In(doc="a")
    choice: Literal["x", "y"] = In(doc="a")
    either: Pose | None = In(doc="a")
    pose2d: Pose2D = In(doc="a")
    what: ObjectClass = In(doc="a")
    seen: DetectedObject = In(doc="a")
    plane: SupportPlane = In(doc="a")
    poses: tuple[Pose, ...] = In(doc="a")
    pair: tuple[float, float] = In(doc="a")
    state: JointPositions = In(doc="a")
    anything: object = In(doc="a")
    on: str = In(doc="a", names="surface")
    named: str = In(doc="a", names="named_pose")
    optional: float | None = In(None, doc="a")


class Choosy(Skill):
    """Takes one of two."""

    one_of = (("a", "b"),)
    a: int | None = In(None, doc="a")
    b: int | None = In(None, doc="b")


class Nothing:
    """A type of which nothing is known."""


class Odd(Skill):
    """Takes what nobody can make."""

    odd: Nothing = In(doc="a")


@pytest.fixture
def world():
    made = ExampleWorld()
    yield made
    made.close()


def occupied(world: ExampleWorld) -> tuple[np.ndarray, float, float]:
    """The map's cells, bottom row first, and where its lower left corner lies."""
    assert world.site.map_file is not None
    data = (world.site.map_file.parent / "map.pgm").read_bytes()
    _, size, _, cells = data.split(b"\n", 3)
    columns, rows = map(int, size.split())
    grid = np.frombuffer(cells, np.uint8).reshape(rows, columns)[::-1] == 0
    return grid, -columns * RESOLUTION / 2, -rows * RESOLUTION / 2


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (0.3, -0.4, 1.2), (-0.5, 1.0, -2.5)])
def test_every_beam_ends_on_something_that_the_map_knows(at: tuple[float, float, float]) -> None:
    world = ExampleWorld(3, ScriptedRobot(base=Pose2D(*at)))
    scan = read_laser(world.robot)
    mount = world.robot.description.kinematics().base_from_frame("laser_link", world.robot.joints)
    odom_from_laser = Pose2D(*at).transform() @ mount
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    ends = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1) * scan.ranges[:, None]
    ends = np.array([odom_from_laser.apply(end) for end in ends])
    grid, left, bottom = occupied(world)
    rows, columns = np.nonzero(grid)
    cells = np.stack([left + (columns + 0.5) * RESOLUTION, bottom + (rows + 0.5) * RESOLUTION], 1)
    gaps = np.linalg.norm(ends[:, None, :2] - cells[None], axis=2).min(axis=1)
    assert (gaps < 0.1).all()
    world.close()


def test_tables_and_walls_are_on_the_map(world: ExampleWorld) -> None:
    grid, left, bottom = occupied(world)

    def taken(x: float, y: float) -> bool:
        return bool(grid[int((y - bottom) / RESOLUTION), int((x - left) / RESOLUTION)])

    for surface in world.site.surfaces.values():
        assert taken(surface.map_from_surface.x, surface.map_from_surface.y)
    assert not taken(world.site.start.x, world.site.start.y)
    assert all(taken(side * HALF[0], 0.3) and taken(0.3, side * HALF[1]) for side in (1, -1))


def test_the_camera_sees_the_table_in_front(world: ExampleWorld) -> None:
    depth = read_camera(world.robot).depth
    assert depth[depth > 0].min() < 3.0


def test_the_map_goes_with_the_world() -> None:
    world = ExampleWorld()
    file = world.site.map_file
    assert file is not None
    assert file.is_file()
    world.close()
    world.close()
    assert not file.exists()


def test_readings_of_the_test_come_first() -> None:
    robot = ScriptedRobot(small_robot(), readings={"laser": lambda robot: "mine"})
    world = ExampleWorld(robot=robot)
    assert robot.read("laser") == "mine"
    assert read_camera(robot)
    world.close()


def test_inputs_fit_their_ports(world: ExampleWorld) -> None:
    from momantu_bt.values.admit import admit

    site, description = world.site, world.robot.description
    values = example_inputs(EveryType, site, description)
    for name, value in values.items():
        admit(value, EveryType.ports[name])
    assert "optional" not in values
    assert values["on"] in site.surfaces
    assert values["named"] in description.named_poses


def test_of_inputs_that_exclude_each_other_one_is_made(world: ExampleWorld) -> None:
    site, description = world.site, world.robot.description
    assert set(example_inputs(Choosy, site, description)) == {"a"}
    assert set(example_inputs(Choosy, site, description, {"b": 1})) == {"b"}


def test_what_has_no_example_is_named(world: ExampleWorld) -> None:
    with pytest.raises(NoExample, match="'odd'"):
        example_inputs(Odd, world.site, world.robot.description)
