"""Ways of the hand that no picture showed are found, and looked at before they are taken."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.gaze.unseen_ways import blind_spot, planned_in_sight
from momantu_skills.manipulation.scene.site_obstacles import FAR, FloorPlan
from momantu_skills.manipulation.scene.surroundings import KEPT, SeenSpace, Support
from momantu_skills.manipulation.scene.swept import corners_along

from momantu_bt.failure import FRAME_UNKNOWN, Failure
from momantu_bt.geometry import Transform
from momantu_bt.messages import CameraImage
from momantu_bt.skill import Compute
from momantu_bt.world import Site

TABLE = Support(np.array([(0.5, -1.0), (1.3, -1.0), (1.3, 1.0), (0.5, 1.0)]), 0.7)
AHEAD = Transform.from_rotation(
    np.array([(0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)]), (0.0, 0.0, 0.8)
)
"""odom_from_camera: at the origin, 0.8 m high, looking along x; it sees 45 degrees to each side."""


def picture() -> CameraImage:
    intrinsics = np.array([(50.0, 0.0, 49.5), (0.0, 50.0, 49.5), (0.0, 0.0, 1.0)])
    depth = np.zeros((100, 100), np.float32)
    return CameraImage(0.0, "eye", np.zeros((100, 100, 3), np.uint8), depth, intrinsics)


NEAREST = 0.25
"""m; depth from which on that camera measures."""


def looks(*cameras: Transform) -> SeenSpace:
    taken = SeenSpace()
    for camera in cameras:
        taken.add(picture(), camera, NEAREST)
    return taken


def arm(
    taken: SeenSpace, known: float = FAR, elbow: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Any:
    """An arm whose joints are the place between the pads; `known` m beside furniture.

    elbow: a corner of its links, from the place between the pads, m.
    """
    scene = SimpleNamespace(
        surroundings=SimpleNamespace(supports=(TABLE,)),
        known=(),
        seen_space=taken,
        model=SimpleNamespace(tip_from_grasp=Transform()),
        own=SimpleNamespace(
            along=lambda state, postures: np.array(postures)[:, None] + [(0.0, 0.0, 0.0), elbow]
        ),
    )
    plan = SimpleNamespace(distance=lambda points: np.full(len(points), known))
    return SimpleNamespace(
        scene=scene,
        service=SimpleNamespace(floor_plan=plan),
        state=SimpleNamespace(odom_from_base=Transform()),
        group=SimpleNamespace(tip_pose=lambda q: Transform(tuple(q))),
    )


def way(start: tuple[float, float, float], end: tuple[float, float, float]) -> Any:
    return [SimpleNamespace(positions=np.linspace(start, end, 60))]


@given(st.floats(0.3, 3.0), st.floats(-0.9, 0.9), st.floats(-0.9, 0.9))
def test_a_point_is_shown_when_it_lies_in_the_cone_of_a_picture(
    x: float, across: float, up: float
) -> None:
    inside = np.array([(x, across * x, 0.8 + up * x)])
    outside = np.array([(x, 1.1 * x, 0.8), (-x, 0.0, 0.8)])
    assert looks(AHEAD).show(inside).all()
    assert not looks(AHEAD).show(outside).any()
    assert not looks().show(inside).any()


@given(st.floats(0.0, 0.8), st.floats(-0.9, 0.9))
def test_nearer_than_it_measures_a_camera_shows_nothing(x: float, across: float) -> None:
    shown = looks(AHEAD).show(np.array([(x, across * x, 0.8)]))
    assert bool(shown[0]) == (x > NEAREST)


def test_only_the_newest_pictures_count() -> None:
    behind = Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)) @ AHEAD
    point = np.array([(1.0, 0.0, 0.8)])
    assert looks(AHEAD, *[behind] * (KEPT - 1)).show(point).all()
    assert not looks(AHEAD, *[behind] * KEPT).show(point).any()


@given(st.floats(0.3, 2.0), st.floats(0.3, 2.0), st.floats(-0.9, 0.9))
def test_a_point_is_hidden_behind_what_stands_before_it_or_beside_the_picture(
    stands: float, x: float, across: float
) -> None:
    image = picture()
    image.depth[:] = stands
    taken = SeenSpace()
    assert taken.hidden(np.zeros((1, 3)), 0.05).all()
    taken.add(image, AHEAD, NEAREST)
    point, beside = (x, across * x, 0.8), (x, 1.1 * x, 0.8)
    hidden = taken.hidden(np.array([point, beside]), 0.05)
    assert hidden[1]
    if abs(x - 0.05 - stands) > 1e-6:
        assert bool(hidden[0]) is (stands < x - 0.05)


def test_a_point_is_hidden_where_nothing_was_measured() -> None:
    image = picture()
    image.depth[:] = 0.0
    taken = SeenSpace()
    taken.add(image, AHEAD, NEAREST)
    assert taken.hidden(np.array([(1.0, 0.0, 0.8)]), 0.05).all()


def test_a_way_in_sight_is_no_blind_spot() -> None:
    assert blind_spot(arm(looks(AHEAD), known=0.0), way((0.6, 0.0, 0.8), (1.2, 0.4, 0.8))) is None


def test_a_way_over_the_unseen_end_of_a_table_is_one() -> None:
    spot = blind_spot(arm(looks(AHEAD)), way((0.6, 0.0, 0.8), (0.6, 0.95, 0.8)))
    assert spot is not None
    assert 0.6 < spot[1] < 0.95


@pytest.mark.parametrize("height", [0.5, 1.1])
def test_below_a_table_and_high_above_it_nothing_stands(height: float) -> None:
    assert blind_spot(arm(looks(AHEAD)), way((0.6, 0.0, height), (0.6, 0.95, height))) is None


def test_high_above_an_edge_a_wall_may_stand() -> None:
    along_the_edge = way((1.25, 0.0, 1.1), (1.25, 0.99, 1.1))
    unseen = arm(looks(), known=0.0)
    assert blind_spot(unseen, along_the_edge) is not None
    assert blind_spot(unseen, way((0.9, 0.0, 1.1), (0.9, 0.8, 1.1))) is None


@pytest.mark.parametrize(("below", "blind"), [(-0.4, True), (0.1, False), (-0.55, False)])
def test_a_link_over_the_unseen_end_of_a_table_counts_where_something_may_stand(
    below: float, blind: bool
) -> None:
    high = way((0.6, 0.0, 1.2), (0.6, 0.2, 1.2))
    assert blind_spot(arm(looks(AHEAD)), high) is None
    spot = blind_spot(arm(looks(AHEAD), elbow=(0.0, 0.75, below)), high)
    assert (spot is not None) is blind
    if spot is not None:
        assert spot == pytest.approx((0.6, 0.87, 0.8), abs=0.05)


def test_a_link_that_is_unseen_for_a_moment_needs_no_look() -> None:
    moment = [SimpleNamespace(positions=np.array([(0.6, 0.2, 1.2)]))]
    assert blind_spot(arm(looks(AHEAD), elbow=(0.0, 0.75, -0.4)), moment) is None
    assert blind_spot(arm(looks(AHEAD), elbow=(0.0, 0.75, -0.4)), moment * 2) is not None


def test_unseen_air_counts_beside_what_the_map_knows() -> None:
    aside = way((0.1, -0.4, 0.8), (0.1, -0.9, 0.8))
    assert blind_spot(arm(looks(AHEAD)), aside) is None
    assert blind_spot(arm(looks(AHEAD), known=0.1), aside) is not None


def test_no_way_has_no_blind_spot() -> None:
    assert blind_spot(arm(looks()), []) is None


def test_the_floor_plan_tells_how_far_what_the_map_knows_is(tmp_path: Any) -> None:
    grey = np.full((20, 20), 254, np.uint8)
    grey[:, 15] = 0
    (tmp_path / "map.pgm").write_bytes(b"P5\n20 20\n255\n" + grey.tobytes())
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    frames: Any = SimpleNamespace(lookup=lambda to, source: Transform((0.5, 0.0, 0.0)))
    plan = FloorPlan(Site("test", map_file=tmp_path / "map.yaml"), frames)
    near = plan.distance(np.array([(0.55, 1.0, 0.3), (1.05, 1.0, 2.0), (9.0, 1.0, 0.3)]))
    assert near == pytest.approx([0.45, 0.0, FAR], abs=1e-6)

    def lost(to: str, source: str) -> Transform:
        raise Failure(FRAME_UNKNOWN, "nobody knows")

    frames.lookup = lost
    assert plan.distance(np.array([(0.55, 1.0, 0.3)])) == pytest.approx([FAR])


class Turning:
    """An arm beside a camera that turns wherever it is told to, or nowhere."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, turns: bool) -> None:
        self.arm = arm(looks(AHEAD))
        self.arm.robot = None
        self.arm.skill = None
        self.arm.observe = self._observe
        self.arm.joints = np.zeros(2)
        self.arm.settle = lambda: iter(())
        self.looked: list[np.ndarray] = []
        self.strays = 0.0
        self._turns = turns
        monkeypatch.setattr("momantu_skills.gaze.unseen_ways.look_at", self._look_at)

    def _look_at(self, skill: Any, robot: Any, point: np.ndarray) -> Any:
        if not self._turns:
            self.arm.joints = self.arm.joints + self.strays
            raise Failure("OUT_OF_VIEW", "the head does not turn that far")
        self.looked.append(point)
        yield "look"

    def _observe(self) -> None:
        if not self.looked:
            return
        x, y, _ = self.looked[-1]
        turn = np.arctan2(y, x)
        pose = Transform((0.0, 0.0, 0.0), (np.cos(turn / 2), 0.0, 0.0, np.sin(turn / 2)))
        self.arm.scene.seen_space.add(picture(), pose @ AHEAD, NEAREST)

    def plan(self, made: Any) -> tuple[Any, int]:
        """The plan that comes of it, and how often it was made."""
        count = 0

        def plan() -> Any:
            nonlocal count
            count += 1
            return made

        going, answer = planned_in_sight(self.arm, plan, lambda way: way, 0.2), None
        while True:
            try:
                step = going.send(answer)
            except StopIteration as end:
                return end.value, count
            answer = step.function() if isinstance(step, Compute) else None


BLIND = way((0.6, 0.0, 0.8), (0.6, 0.95, 0.8))


def test_a_blind_way_is_looked_at_and_planned_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    turning = Turning(monkeypatch, turns=True)
    assert turning.plan(BLIND) == (BLIND, 2)
    assert len(turning.looked) == 1


def test_a_way_in_sight_is_taken_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    turning = Turning(monkeypatch, turns=True)
    straight = way((0.6, 0.0, 0.8), (1.2, 0.4, 0.8))
    assert turning.plan(straight) == (straight, 1)
    assert turning.looked == []


def test_what_cannot_be_looked_at_stays_in_doubt(monkeypatch: pytest.MonkeyPatch) -> None:
    turning = Turning(monkeypatch, turns=False)
    assert turning.plan(BLIND) == (BLIND, 1)
    assert turning.looked == []


def test_an_arm_that_was_held_up_on_its_way_to_look_plans_from_where_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    turning = Turning(monkeypatch, turns=False)
    turning.strays = 0.4
    assert turning.plan(BLIND) == (BLIND, 2)
    assert turning.looked == []


def test_an_arm_whose_links_have_no_shape_has_no_corners() -> None:
    nobody: Any = SimpleNamespace()
    assert corners_along(nobody, (), nobody, [np.zeros(2)] * 3).shape == (3, 0, 3)


def test_without_corners_only_the_hand_counts() -> None:
    bare = arm(looks(AHEAD))
    bare.scene.own.along = lambda state, postures: np.empty((len(postures), 0, 3))
    assert blind_spot(bare, way((0.6, 0.0, 0.8), (1.2, 0.4, 0.8))) is None
    assert blind_spot(bare, BLIND) is not None
