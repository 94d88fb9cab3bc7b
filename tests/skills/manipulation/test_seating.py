"""Where along the fingers a round thing is held: where they press through its axis."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.hand.grasps import Grasp, grasps_for
from momantu_skills.manipulation.hand.seating import FIRM, SQUARE, STEP, Seat
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_worlds.robots import fetch, kinova_jackal
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.messages import DetectedObject

HAND = fetch().hand.model_copy(update={"pad_length": 0.1, "hand_clearance": 0.08})
PALM = arm_model(fetch()).palm
RADIUS = 0.035
AHEAD = 0.015
"""Where the inner edge of the pads of `edged` is ahead of the grasp frame, m."""
ERROR = math.radians(2.5)
"""Step of the angles that are looked at, and the opening's error."""

Closing = Callable[[float], Sequence[Array]]


def fingers(outline: Sequence[tuple[float, float]]) -> Closing:
    """Two fingers by the corners (x, y) of the one ahead along y; the innermost is at y = 0."""

    def closing(width: float) -> list[Array]:
        found = []
        for side in (1.0, -1.0):
            corners = [(x, side * (y + width / 2), z) for x, y in outline for z in (-0.02, 0.02)]
            found.append(np.asarray(ConvexHull(np.array(corners)).equations))
        return found

    return closing


def edged(ahead: float = AHEAD) -> Closing:
    """A pad that begins at an edge and leans outwards from there by 20 degrees."""
    far = 0.05
    leaning = (far - ahead) * math.tan(math.radians(20))
    return fingers([(ahead, 0.0), (far, leaning), (far, leaning + 0.01), (ahead, 0.01)])


def leaning(angle: float) -> Closing:
    """Straight fingers that lean outwards all along."""
    rise = 0.1 * math.tan(angle)
    return fingers([(-0.05, 0.0), (0.05, rise), (0.05, rise + 0.01), (-0.05, 0.01)])


def seat(closing: Closing) -> Seat:
    return Seat(HAND, RADIUS, closing)


def level(closing: Closing | None, size: tuple[float, float, float], shape: str) -> list[Grasp]:
    pose = Pose(Transform((0.8, 0.0, 0.8)), "odom", 0.0)
    thing = DetectedObject("thing", pose, size, shape, 0.9, 0.8 - size[2] / 2)
    every = grasps_for(thing, HAND, PALM, closing=closing)
    return [grasp for grasp in every if abs(grasp.object_from_grasp.rotation[2, 0]) < 0.01]


def behind(grasp: Grasp) -> float:
    """How far the grasp frame is behind the thing's axis, m."""
    frame = grasp.object_from_grasp
    return -float(frame.position[:2] @ frame.rotation[:2, 0])


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.01, 0.03))
def test_the_forces_of_an_edge_lean_as_the_surface_there(back: float) -> None:
    expected = abs(math.asin((AHEAD - back) / RADIUS))
    if back > AHEAD:  # then the pad's face touches, but no more than it leans itself
        expected = min(expected, math.radians(20))
    assert seat(edged()).lean(back) == pytest.approx(expected, abs=ERROR)


@settings(max_examples=15, deadline=None)
@given(st.floats(0.0, 0.5), st.floats(0.0, 0.03))
def test_those_of_a_face_lean_as_the_face_wherever_it_touches(angle: float, back: float) -> None:
    assert seat(leaning(angle)).lean(back) == pytest.approx(angle, abs=ERROR)


def test_a_thing_is_held_where_an_edge_presses_through_its_axis() -> None:
    held = seat(edged())
    place = held.best(0.0, 0.04)
    assert place == pytest.approx(AHEAD, abs=STEP)
    assert held.lean(0.0) > FIRM
    assert held.lean(place) <= SQUARE


def test_what_is_firm_already_stays_where_it_is() -> None:
    assert seat(edged(0.008)).best(0.0, 0.04) == 0.0
    assert seat(leaning(0.0)).best(0.01, 0.04) == 0.01


def test_fingers_that_lean_all_along_hold_as_they_can() -> None:
    assert seat(leaning(math.radians(30))).best(0.0, 0.04) == 0.0


def test_no_place_beyond_the_pads_is_taken() -> None:
    assert seat(edged(0.03)).best(0.0, 0.02) == 0.0
    assert seat(edged(0.03)).best(0.03, 0.02) == 0.03


def test_grasps_of_a_can_take_the_seat_and_grasps_of_a_box_do_not() -> None:
    can, box = (0.07, 0.07, 0.13), (0.07, 0.07, 0.13)
    assert {round(behind(g), 3) for g in level(edged(), can, "cylinder")} == {AHEAD}
    assert {round(behind(g), 3) for g in level(None, can, "cylinder")} == {0.0}
    boxes = [{round(behind(g), 3) for g in level(c, box, "box")} for c in (edged(), None)]
    assert boxes[0] == boxes[1]


@pytest.mark.parametrize("robot", [fetch, kinova_jackal])
def test_hands_whose_pads_face_each_other_hold_a_can_as_deep_as_they_reach(robot: Callable) -> None:
    model = arm_model(robot())
    held = Seat(model.description.hand, RADIUS, model.fingers_at)
    assert held.best(0.0, model.description.hand.pad_length / 2 - 0.012) == 0.0


def knuckled(width: float) -> list[Array]:
    """Pads 4 cm long on knuckles that reach 15 mm farther inwards, 2 cm behind the pads."""
    pads = fingers([(-0.02, 0.0), (0.05, 0.0), (0.05, 0.01), (-0.02, 0.01)])(width)
    return pads + fingers([(-0.1, -0.015), (-0.04, -0.015), (-0.02, 0.0), (-0.1, 0.01)])(width)


def test_from_above_knuckles_stay_over_the_rim() -> None:
    size = (2 * RADIUS, 2 * RADIUS, 0.13)
    thing = DetectedObject(
        "can", Pose(Transform((0.8, 0.0, 0.8)), "odom", 0.0), size, "cylinder", 0.9, 0.735
    )
    rim = np.array([(RADIUS * c, RADIUS * s, 0.065) for c, s in _circle()])

    def deepest(closing: Closing | None) -> float:
        found = grasps_for(thing, HAND, PALM, closing=closing)
        above = [g.object_from_grasp for g in found if g.object_from_grasp.rotation[2, 0] < -0.99]
        assert above
        locals_ = [frame.inverse().apply(rim) for frame in above]
        return min(
            float((local @ planes[:, :3].T + planes[:, 3]).max(axis=1).min())
            for local in locals_
            for planes in knuckled(2 * RADIUS)
        )

    assert deepest(None) < -0.006
    assert deepest(knuckled) > -0.003


def _circle() -> list[tuple[float, float]]:
    return [(math.cos(a), math.sin(a)) for a in np.linspace(0, 2 * math.pi, 90)]
