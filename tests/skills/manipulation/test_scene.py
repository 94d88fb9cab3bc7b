"""The scene: what it sees, what it believes to be held, and what of it is the robot."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.hulls import LinkMask, floor_outline
from momantu_skills.manipulation.scene.holding import Holding
from momantu_skills.manipulation.scene.surroundings import (
    EDGE,
    Support,
    Surroundings,
    cells_of,
    known_support,
    merged,
    same_surface,
    support_around,
    support_of_plane,
    within,
)
from momantu_skills.perception.camera.snapshot import take

from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import DetectedObject, RobotState, SupportPlane
from momantu_bt.service import HeldObject
from momantu_bt.world import Surface
from tests.skills.scenery.table import SceneOf, Tabletop

CONFIG = SceneConfig()
CAN = DetectedObject(
    "can",
    Pose(Transform((0.8, 0.0, 0.785)), "odom", 0.0),
    (0.07, 0.07, 0.13),
    "cylinder",
    0.9,
    0.72,
)
HELD = HeldObject(CAN, Transform((0.007, 0.0, 0.0)))


def state(width: float, effort: float, stamp: float = 0.0) -> RobotState:
    none = np.empty(0)
    return RobotState(stamp, (), none, none, none, Transform(), 0.0, 0.0, width, effort)


def holding() -> Holding:
    belief = Holding(CONFIG)
    belief.claim(HELD, 0.07, 1.0)
    return belief


def test_a_grasp_is_believed_while_width_and_effort_agree() -> None:
    belief = holding()
    for _ in range(50):
        belief.judge(state(0.0705, 44.0))
    assert belief.held is HELD
    assert belief.last_contact == 1.0


@pytest.mark.parametrize("width", [0.04, 0.058, 0.083])
def test_an_object_that_turns_between_the_fingers_is_still_held(width: float) -> None:
    belief = holding()
    for i in range(50):
        belief.judge(state(width, 44.0, 2.0 + i))
    assert belief.held is HELD
    assert belief.last_contact == 1.0


@pytest.mark.parametrize(("width", "effort"), [(0.07, 0.5), (0.04, 0.0), (0.001, 44.0)])
def test_fingers_that_press_on_nothing_have_lost_it(width: float, effort: float) -> None:
    belief = holding()
    for i in range(CONFIG.doubt):
        assert belief.held is HELD
        belief.judge(state(width, effort, 2.0 + i))
    assert belief.held is None
    assert belief.last_contact == 2.0 + CONFIG.doubt - 1


def lost() -> Holding:
    belief = holding()
    for i in range(CONFIG.doubt):
        belief.judge(state(0.07, 0.0, 2.0 + i))
    assert belief.held is None
    return belief


def press(belief: Holding, width: float) -> None:
    for i in range(CONFIG.doubt):
        belief.judge(state(width, 44.0, 10.0 + i))


def test_fingers_that_press_again_before_they_opened_hold_it_again() -> None:
    belief = lost()
    press(belief, 0.06)
    assert belief.held is HELD
    assert belief.last_contact == 10.0 + CONFIG.doubt - 1


def test_fingers_that_have_opened_hold_something_else() -> None:
    belief = lost()
    belief.judge(state(0.095, 0.0, 9.0))
    press(belief, 0.07)
    assert belief.held is None


def test_what_was_released_is_not_held_again() -> None:
    belief = lost()
    belief.release(9.0)
    press(belief, 0.07)
    assert belief.held is None


def closing() -> Holding:
    belief = Holding(CONFIG)
    belief.expect(HELD, 0.095)
    for i in range(CONFIG.doubt):
        belief.judge(state(0.09 - 0.01 * i, 0.0, 1.0 + 0.1 * i))
    assert belief.held is None
    return belief


def test_what_the_fingers_close_on_is_held_once_they_press_on_it() -> None:
    belief = closing()
    press(belief, 0.07)
    assert belief.held is HELD


def test_what_the_fingers_missed_is_not_held() -> None:
    belief = closing()
    press(belief, 0.001)
    assert belief.held is None
    belief.release(20.0)
    press(belief, 0.07)
    assert belief.held is None


def test_a_bounce_does_not() -> None:
    belief = holding()
    for i in range(40):
        belief.judge(state(0.07, 44.0 if i % CONFIG.doubt else 0.0))
    assert belief.held is HELD


def test_letting_go_is_a_contact() -> None:
    belief = holding()
    belief.release(5.0)
    assert belief.held is None
    assert belief.last_contact == 5.0


def test_before_anything_was_touched_there_was_no_contact() -> None:
    assert Holding(CONFIG).last_contact == -math.inf


@given(st.integers(0, 1000))
def test_points_within_links_are_the_robot_and_far_ones_are_not(seed: int) -> None:
    random = np.random.default_rng(seed)
    hull = random.uniform(-0.1, 0.1, (30, 3))
    pose = Transform(random.uniform(-1, 1, 3), random.normal(size=4)).matrix
    mask = LinkMask({"link": hull}, 0.02)
    weights = random.dirichlet(np.ones(len(hull)), 200)
    inside = (weights @ hull) @ pose[:3, :3].T + pose[:3, 3]
    assert mask.covers(inside, {"link": pose}).all()
    ways = random.normal(size=(200, 3))
    far = pose[:3, 3] + 0.4 * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    assert not mask.covers(far, {"link": pose}).any()


def test_the_robot_and_what_it_holds_are_told_from_the_rest(
    tabletop: type[Tabletop], scene_of: SceneOf, model: ArmModel
) -> None:
    robot = tabletop(pose="carry")
    service = scene_of(robot)
    poses = model.link_poses(model.configuration(robot.state()))
    own = np.vstack([h @ poses[k][:3, :3].T + poses[k][:3, 3] for k, h in model.hulls.items()])
    assert service.is_robot(own, robot.state()).all()
    in_hand = robot.odom_from_hand.apply([[0.03, 0.0, 0.06], [0.03, 0.0, -0.06]])
    assert not service.is_robot(in_hand, robot.state()).any()
    service.holding.claim(HELD, 0.07, 0.0)
    assert service.is_robot(in_hand, robot.state()).all()
    assert not service.is_robot(np.array([[1.0, 0.0, 0.5]]), robot.state()).any()


def test_the_footprint_covers_base_arm_and_what_is_held(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    home, carry = tabletop(pose="home"), tabletop(pose="carry")
    folded = scene_of(home).footprint(home.state())
    service = scene_of(carry)
    stretched = service.footprint(carry.state())
    service.holding.claim(HELD, 0.07, 0.0)
    loaded = service.footprint(carry.state())
    assert folded[:, 0].max() < 0.35
    assert stretched[:, 0].max() > 0.42
    assert loaded[:, 0].max() > stretched[:, 0].max() + 0.005
    for outline in (folded, stretched, loaded):
        edges = np.roll(outline, -1, axis=0) - outline
        after = np.roll(edges, -1, axis=0)
        assert (edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] > -1e-12).all()


def test_the_footprint_below_a_height_is_of_what_hangs_lower(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop(pose="carry")
    service, state = scene_of(robot), robot.state()
    service.holding.claim(HELD, 0.07, 0.0)
    held = robot.odom_from_hand.position[2] - HELD.object.size[2] / 2
    base = np.array(robot.description.footprint)[:, 0].max()
    front = [service.footprint(state, below)[:, 0].max() for below in (0.0, held + 0.02, math.inf)]
    assert front[0] == pytest.approx(base, abs=1e-9)
    assert front[0] < front[1] == front[2]


def test_a_thin_wall_is_held_until_the_fingers_are_closed() -> None:
    belief = Holding(CONFIG)
    belief.claim(HELD, 0.021, 1.0)
    for width in np.linspace(0.021, 0.004, 10):
        belief.judge(state(float(width), 45.0))
    assert belief.held is HELD
    for _ in range(CONFIG.doubt):
        belief.judge(state(0.0005, 45.0))
    assert belief.held is None


def test_an_outline_is_convex_and_holds_every_corner() -> None:
    corners = np.random.default_rng(0).normal(size=(50, 3))
    outline = floor_outline(corners)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        side = (b - a)[0] * (corners[:, 1] - a[1]) - (b - a)[1] * (corners[:, 0] - a[0])
        assert (side > -1e-9).all()


def test_cells_cover_what_was_seen_and_some_depth_behind_it() -> None:
    face = np.array([(1.0, y, z) for y in np.arange(-0.1, 0.1, 0.004) for z in (0.8, 0.803)])
    cells = cells_of(face, np.array([0.0, 0.0, 1.4]), 0.06, CONFIG)
    for point in face:
        assert np.abs(cells - point).max(axis=1).min() <= CONFIG.voxel / 2 + 1e-9
    behind = Transform((CONFIG.thickness - 0.5 * CONFIG.voxel, 0.0, 0.0)).apply(face)
    for point in behind[::10]:
        assert np.abs(cells - point).max(axis=1).min() <= CONFIG.voxel
    assert cells[:, 0].min() > 1.0 - CONFIG.voxel
    assert cells[:, 0].max() < 1.0 + CONFIG.thickness + CONFIG.voxel


def test_lone_points_and_the_floor_are_no_cells() -> None:
    points = np.array([[1.0, 0.0, 0.8], [0.5, 0.5, 0.01], [0.5, 0.5, 0.012]])
    assert len(cells_of(points, np.zeros(3), 0.06, CONFIG)) == 0


def test_cells_in_a_box_can_be_ignored() -> None:
    around = Surroundings(np.array([[1.0, 0.0, 0.8], [1.0, 0.3, 0.8]]))
    left = around.without(Transform((1.0, 0.0, 0.8)), (0.05, 0.05, 0.05))
    assert left.cells.tolist() == [[1.0, 0.3, 0.8]]


def grid(x: tuple[float, float], y: tuple[float, float], z: float) -> np.ndarray:
    xs, ys = np.meshgrid(np.arange(*x, 0.02), np.arange(*y, 0.02))
    return np.column_stack([xs.ravel(), ys.ravel(), np.full(xs.size, z)])


def test_a_support_is_the_patch_below_the_object_not_another_at_its_height() -> None:
    top, other = grid((0.6, 1.0), (-0.3, 0.3), 0.72), grid((0.6, 1.0), (0.8, 1.2), 0.72)
    found = support_around(np.vstack([top, other]), np.array([0.8, 0.0]), 0.72, 0.015)
    assert found is not None
    assert found.outline[:, 1].max() < 0.31
    assert found.outline[:, 0].min() == pytest.approx(0.6, abs=0.01)
    solid = found.obstacle(Transform(), "support")
    assert solid.support
    assert solid.corners[:, 2].max() == pytest.approx(0.72)


def test_a_support_keeps_the_arm_off_the_edge_that_pictures_miss() -> None:
    top = Support(square((0.6, 1.0), (-0.3, 0.3)), 0.72)
    corners = top.obstacle(Transform(), "support").corners
    for axis, (low, high) in enumerate(((0.6, 1.0), (-0.3, 0.3))):
        assert corners[:, axis].min() == pytest.approx(low - EDGE)
        assert corners[:, axis].max() == pytest.approx(high + EDGE)


def test_too_few_points_are_no_support() -> None:
    assert support_around(np.empty((0, 3)), np.zeros(2), 0.7, 0.015) is None
    few = np.array([[0.0, 0.0, 0.7], [0.01, 0.0, 0.7], [0.0, 0.01, 0.7]])
    assert support_around(few, np.zeros(2), 0.7, 0.015) is None


def test_a_plane_becomes_the_same_support_in_odom() -> None:
    pose = Transform((1.0, 2.0, 0.5), Pose2D(0, 0, math.pi / 2).transform().quaternion)
    plane = SupportPlane(Pose(pose, "odom", 0.0), ((0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.0, 0.2)))
    support = support_of_plane(plane)
    assert support.height == pytest.approx(0.5)
    assert support.outline == pytest.approx(
        np.array([[1.0, 2.0], [1.0, 2.4], [0.8, 2.4], [0.8, 2.0]])
    )


def square(x: tuple[float, float], y: tuple[float, float]) -> np.ndarray:
    return np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])


def test_a_known_surface_reaches_beyond_the_picture_at_the_height_seen() -> None:
    surface = Surface(Pose2D(1.0, 0.0, 0.0), (0.8, 1.6), 0.7, (math.pi,))
    known = known_support(surface, Transform())
    seen = Support(square((0.62, 1.2), (-0.3, 0.3)), 0.69)
    assert same_surface(seen, known)
    whole = merged(seen, known)
    assert whole.height == 0.69
    assert within(np.array([[1.0, 0.6], [1.0, -0.6], [0.63, 0.0]]), whole.outline).all()
    assert not within(np.array([[0.55, 0.0], [1.0, 0.9]]), whole.outline).any()


@pytest.mark.parametrize(
    "seen",
    [
        Support(square((0.62, 1.2), (-0.3, 0.3)), 0.5),
        Support(square((2.6, 3.2), (-0.3, 0.3)), 0.7),
    ],
)
def test_another_patch_is_not_the_known_surface(seen: Support) -> None:
    surface = Surface(Pose2D(1.0, 0.0, 0.0), (0.8, 1.6), 0.7, (math.pi,))
    assert not same_surface(seen, known_support(surface, Transform()))


def test_surfaces_that_no_picture_showed_are_kept_clear_of(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    """The site has table_a at (2, 0); the hand is in it once localization says so."""
    robot = tabletop(can=None, pose="carry")
    scene = scene_of(robot)
    scene.frames.add_state(robot.state())
    q = scene.scene.model.joints(robot.state())
    robot.table = 0.01
    for ahead, free in ((0.0, True), (1.6, False)):
        scene.frames.set_map_from_odom(Transform((ahead, 0.0, -0.15)), robot.now())
        scene.observe(take(robot, scene.frames))
        world = scene.scene.world(robot.state(), None, 0.0)
        assert world.free(q) is free, world.touching(q)


def test_a_picture_replaces_what_it_sees_through(
    tabletop: type[Tabletop], scene_of: SceneOf
) -> None:
    robot = tabletop()
    scene = scene_of(robot)
    scene.frames.add_state(robot.state())
    scene.observe(take(robot, scene.frames))

    def near_can() -> int:
        """Cells of the can above what its shape hides of the table."""
        cells = scene.scene.surroundings.cells
        away = np.linalg.norm(cells[:, :2] - (0.75, 0.0), axis=1)
        return int(((away < 0.06) & (cells[:, 2] > 0.77)).sum())

    assert near_can() > 20
    robot.can = None
    robot.advance(0.05)
    scene.frames.add_state(robot.state())
    scene.observe(take(robot, scene.frames))
    assert near_can() == 0


def test_it_reads_no_camera_by_itself(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    robot = tabletop()
    robot.dead.add("head_camera")
    scene = scene_of(robot)
    for i in range(5):
        scene.update(robot, i * 0.05)
    assert scene.published() == {"holding": ""}
    scene.holding.claim(HELD, 0.07, 0.0)
    assert scene.published() == {"holding": "can"}
