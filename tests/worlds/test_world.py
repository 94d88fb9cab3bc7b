"""`four_rooms` as the framework meets it: cheap to ask, whole once opened."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.world import SapienWorld
from momantu_worlds.worlds import four_rooms

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import RobotDescription, read_camera, read_laser
from momantu_bt.world import TICK, World, WorldEntry, WorldError

FETCH = fetch()


@pytest.fixture(scope="module")
def world() -> Iterator[SapienWorld]:
    opened = four_rooms.open(FETCH, 1)
    assert isinstance(opened, SapienWorld)
    yield opened
    opened.close()


def keeps_the_contracts(entry: WorldEntry, opened: World) -> tuple[WorldEntry, World]:
    """Typed arguments: the type checker proves that both protocols are kept."""
    return entry, opened


def test_the_site_is_read_without_a_simulator() -> None:
    code = (
        "import sys; from momantu_worlds.worlds import four_rooms; s = four_rooms.site(); "
        "print(*s.surfaces, [m for m in ('sapien', 'cv2', 'torch', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "table_a table_b []"


def test_the_clock_advances_by_whole_ticks(world: SapienWorld) -> None:
    keeps_the_contracts(four_rooms, world)
    before = world.now()
    for _ in range(7):
        world.step()
    assert world.now() == pytest.approx(before + 7 * TICK, abs=1e-12)
    assert world.robot.state().stamp == world.now()


def test_the_robot_stands_where_the_rough_start_says(world: SapienWorld) -> None:
    truth, rough = world.simulator.truth.base(), world.site.start
    assert truth.distance_to(rough) < 0.31
    assert abs((truth.inverse() @ rough).yaw) < np.radians(15.1)


def test_everything_rests_at_the_start_and_nothing_touches_the_robot(world: SapienWorld) -> None:
    for _ in range(5):
        world.step()
    truth = world.simulator.truth
    assert all(truth.speed(name)[0] < 1e-3 for name in truth.bodies)
    assert not [c for c in truth.contacts() if c.first in truth.robot_links]


def test_the_laser_sees_the_walls_of_the_map(world: SapienWorld) -> None:
    scan = read_laser(world.robot)
    assert np.mean(scan.ranges < scan.range_max) > 0.9


def test_the_camera_sees_the_room(world: SapienWorld) -> None:
    image = read_camera(world.robot)
    assert image.color.shape == (480, 640, 3)
    assert image.color.std() > 5.0
    assert np.mean(image.depth > 0) > 0.5


def test_at_first_the_job_is_not_done(world: SapienWorld) -> None:
    verdict = world.verdict()
    assert verdict is not None
    assert not verdict.success
    assert verdict.unmet


def test_a_world_without_referee_has_no_word_and_runs_the_same() -> None:
    states = []
    for referee in (True, False):
        opened = four_rooms.open(FETCH, 2, referee=referee)
        for _ in range(15):
            opened.robot.command("base", BaseVelocity(0.3, 0.3))
            opened.step()
        assert (opened.verdict() is None) is (not referee)
        assert isinstance(opened, SapienWorld)
        states.append(opened.simulator.state_bytes())
        opened.close()
        opened.close()
    assert states[0] == states[1]


def test_seeds_differ_and_repeat() -> None:
    def start(seed: int) -> Pose2D:
        opened = four_rooms.open(FETCH, seed)
        assert isinstance(opened, SapienWorld)
        pose = opened.simulator.truth.base()
        opened.close()
        return pose

    assert start(3) == start(3)
    assert start(3) != start(4)


def test_a_robot_without_a_simulation_model_is_refused() -> None:
    stranger: RobotDescription = FETCH.model_copy(update={"name": "stranger"})
    with pytest.raises(WorldError, match=r"'stranger'.*fetch"):
        four_rooms.open(stranger, 0)
