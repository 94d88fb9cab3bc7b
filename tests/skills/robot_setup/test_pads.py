"""Pads that lean from each other are told, by how they would hold a can."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import cast

import pytest
from momantu_skills.manipulation.model.arm_model import ArmModel, arm_model
from momantu_skills.robot_setup.check.pads import SLIDES, check_pads
from momantu_worlds.robots import fetch, kinova_jackal

from momantu_bt.findings import FindingAtKeys
from tests.skills.manipulation.test_seating import HAND, Closing, edged, leaning


def told(closing: Closing, max_width: float = 0.1) -> list[FindingAtKeys]:
    """What is found about a hand whose fingers close so."""
    hand = HAND.model_copy(update={"max_width": max_width})
    description = SimpleNamespace(hand=hand)
    model = SimpleNamespace(
        description=description, open_fingers=closing(max_width), fingers_at=closing
    )
    return list(check_pads(cast("ArmModel", model)))


def test_an_edge_that_holds_a_can_is_told_in_one_sentence() -> None:
    (finding,) = told(edged())
    assert finding.code == "pads-lean"
    assert finding.keys == ("end_effector", "frame")
    assert "at a width of 70 mm" in finding.message
    assert "26 deg off the closing direction" in finding.message
    assert "15 mm farther out, by an edge" in finding.message
    assert ". " not in finding.message
    assert "parallel" in finding.hint


def test_fingers_out_of_which_a_can_slides_are_told() -> None:
    (finding,) = told(leaning(SLIDES + math.radians(6)))
    assert finding.code == "pads-lean"
    assert "slide out" in finding.message


def test_faces_that_lean_less_than_friction_holds_are_fine() -> None:
    assert told(leaning(SLIDES - math.radians(6))) == []
    assert told(leaning(0.0)) == []


def test_a_hand_that_opens_less_than_a_can_is_judged_by_what_fits() -> None:
    (finding,) = told(edged(), max_width=0.05)
    assert "at a width of 36 mm" in finding.message
    assert told(edged(), max_width=0.012) == []


@pytest.mark.parametrize("robot", [fetch, kinova_jackal], ids=["fetch", "kinova_jackal"])
def test_hands_that_hold_cans_are_fine(robot: object) -> None:
    assert list(check_pads(arm_model(robot()))) == []  # type: ignore[operator]
