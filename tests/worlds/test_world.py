"""`four_rooms` as the framework meets it: cheap to ask, whole once opened."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.simulated_world import SapienWorld
from momantu_worlds.worlds import four_rooms

from momantu_bt.claim import (
    BaseAt,
    BaseNear,
    CameraOn,
    GripperOpen,
    Holding,
    JointsAt,
    Judge,
    ObjectAt,
    ObjectOn,
    Sentence,
    TagAt,
    TagOn,
)
from momantu_bt.descriptions.goal import parse_demands
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.goal import DemandingWorld, Goal
from momantu_bt.messages import BaseVelocity, JointPositions
from momantu_bt.robot import RobotDescription, read_camera, read_laser
from momantu_bt.world import TICK, Demanded, World, WorldEntry, WorldError

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


def test_what_is_true_in_the_map_is_true_in_odometry_however_far_that_has_drifted() -> None:
    """A robot that drives a bend on purpose: the judge brings its poses back into the map."""
    opened = four_rooms.open(FETCH, 5)
    assert isinstance(opened, SapienWorld)
    for _ in range(60):
        opened.robot.command("base", BaseVelocity(0.2, 0.8))
        opened.robot.command("head", JointPositions(("head_pan_joint", "head_tilt_joint"), (0, 0)))
        opened.step()
    for _ in range(30):
        opened.step()
    truth, odometry = opened.simulator.truth, opened.robot.state().odom_from_base
    odom_from_map = odometry @ truth.base().transform().inverse()
    drift = (opened.site.start.transform() @ odometry).position - truth.base().transform().position
    assert np.linalg.norm(drift) > 0.05
    can = odom_from_map @ truth.pose("can") @ Transform((0.0, 0.0, 0.065))
    tag = odom_from_map @ truth.pose("tag")
    wanted = opened.site.objects["can"]
    x, y, z = (float(v) for v in can.position)
    frame = FETCH.camera()[1].frame
    ahead = odom_from_map @ truth.link(frame) @ Transform((0.0, 0.0, 2.0))
    home = FETCH.named_poses["home"]
    arm = FETCH.actuators["arm"].joints
    sentences: list[tuple[Sentence, bool]] = [
        (ObjectAt(wanted, can, 0.001), True),
        (ObjectAt(wanted, can @ Transform((0.01, 0.0, 0.0)), 0.001), False),
        (ObjectOn(wanted, "table_a"), True),
        (ObjectOn(wanted, "table_b"), False),
        (TagAt(1, tag, 0.001, 0.002), True),
        (TagOn(1, "table_b"), True),
        (TagOn(2), False),
        (BaseAt(truth.base(), 1e-6, 1e-6), True),
        (BaseAt(truth.base() @ Pose2D(0.0, 0.0, 0.2), 0.1, 0.1), False),
        (BaseNear((x, y), truth.base().distance_to(_floor(truth.pose("can"))) + 1e-3), True),
        (BaseNear((x, y), truth.base().distance_to(_floor(truth.pose("can"))) - 1e-3), False),
        (CameraOn(frame, _xyz(ahead), 1e-3), True),
        (CameraOn(frame, (x, y, z - 9.0), 0.3), False),
        (JointsAt(arm, tuple(home[name] for name in arm), 0.01), True),
        (JointsAt(("head_tilt_joint",), (home["head_tilt_joint"],), 0.1), False),
        (GripperOpen(0.09), True),
        (Holding(False), True),
    ]
    judge: Judge = opened
    told = [(str(s), judge.judge(s, odometry)) for s, _ in sentences]
    assert told == [(str(s), said) for s, said in sentences]
    opened.close()


def _floor(pose: Transform) -> Pose2D:
    return Pose2D.from_transform(pose)


def _xyz(pose: Transform) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in pose.position)
    return x, y, z


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


def test_the_referee_demands_what_it_is_told_from_where_it_is_written() -> None:
    opened = four_rooms.open(FETCH, 2)
    assert isinstance(opened, DemandingWorld)
    own = opened.verdict()
    assert own is not None
    (demanded,) = own.demands
    assert demanded.demand == "can on table_b beside tag"
    name, line = demanded.place.split(":")
    text = four_rooms.path.read_text(encoding="utf-8").splitlines()
    assert (name, text[int(line) - 1]) == ("four_rooms.yaml", "goal:")
    opened.demand(Goal(parse_demands(["can on table_a"]), "t.yaml:3"))
    for _ in range(25):
        opened.step()
    stands = opened.verdict()
    assert stands is not None
    assert stands.success
    assert stands.demands == (Demanded("can on table_a", "t.yaml:3", True),)
    opened.demand(None)
    opened.step()
    nothing = opened.verdict()
    assert nothing is not None
    assert (nothing.success, nothing.unmet) == (None, ())
    with pytest.raises(WorldError, match=r"the goal \(t.yaml:3\) is not possible here: .*'kan'"):
        opened.demand(Goal(parse_demands("kan on table_a"), "t.yaml:3"))
    opened.close()


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
    stranger: RobotDescription = FETCH.model_copy(update={"name": "stranger", "simulation": None})
    with pytest.raises(WorldError, match=r"'stranger' cannot be simulated.*`simulation`"):
        four_rooms.open(stranger, 0)
