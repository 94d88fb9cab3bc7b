"""Laws of proposed limits: within the URDF's, readable, and honest about what was guessed."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.robot_setup.find.limits import (
    GENTLE,
    LIGHT,
    SLOWEST,
    USABLE,
    USUAL_SPEED,
    FoundLimit,
    find_limits,
    plain_limits,
)
from momantu_skills.robot_setup.urdf.skeleton import SetupError

from tests.skills.robot_setup.conftest import body_of, box, joint, link

BASE = link("base_link", box(0.4, 0.4, 0.2), "0 0 0.1")
ARM = link("arm", box(0.1, 0.1, 0.4), "0 0 0.2", mass=2.0)


def found(kind: str, limit: str, light: bool = False) -> FoundLimit:
    body = body_of(BASE, ARM, joint("j", "base_link", "arm", axis="0 1 0", kind=kind, limit=limit))
    limits = find_limits(body, ["j"], ["j"] if light else [])
    assert plain_limits(limits) == {"j": limits["j"].limit}
    return limits["j"]


POSITION = st.floats(-7, 7, allow_subnormal=False)


@given(
    st.sampled_from(["revolute", "prismatic"]),
    st.tuples(POSITION, POSITION).filter(lambda range_: range_[1] - range_[0] > 2e-4),
    st.floats(1e-4, 60),
    st.floats(1e-4, 500),
    st.booleans(),
)
@settings(max_examples=60)
def test_proposed_limits_lie_within_the_urdfs(
    kind: str, ends: tuple[float, float], velocity: float, effort: float, light: bool
) -> None:
    low, high = ends
    written = f'lower="{low!r}" upper="{high!r}" velocity="{velocity!r}" effort="{effort!r}"'
    limit = found(kind, written, light).limit
    assert limit.lower is not None
    assert limit.upper is not None
    assert low <= limit.lower < limit.upper <= high
    assert limit.lower - low < 1.1e-5 > high - limit.upper
    assert 0.999 * velocity < limit.velocity <= velocity
    assert SLOWEST <= limit.acceleration <= GENTLE[kind] * (LIGHT if light else 1.0)


def test_half_of_the_effort_accelerates_what_hangs_on_the_joint() -> None:
    # a rod's inertia about its end, and the tensor that is given at the link's own frame
    weak = found("revolute", 'lower="-1" upper="1" velocity="1" effort="0.01"')
    assert weak.limit.acceleration == pytest.approx(USABLE * 0.01 / 0.02, rel=1e-3)
    slide = found("prismatic", 'lower="-1" upper="1" velocity="1" effort="0.5"')
    assert slide.limit.acceleration == pytest.approx(USABLE * 0.5 / 2.0, rel=1e-3)
    assert weak.guessed == slide.guessed == ()


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous"])
@pytest.mark.parametrize("given", ['velocity="0" effort="0"', ""])
def test_what_the_urdf_leaves_out_is_guessed_and_said(kind: str, given: str) -> None:
    limit = found(kind, f'lower="-1" upper="1" {given}')
    assert limit.limit.velocity == USUAL_SPEED[kind]
    assert limit.limit.acceleration == GENTLE[kind]
    assert [text.split()[0] for text in limit.guessed] == ["acceleration", "velocity"]


def test_an_endless_joint_has_no_ends() -> None:
    limit = found("continuous", "").limit
    assert (limit.lower, limit.upper) == (None, None)


def test_a_hinge_whose_ends_nobody_gave_turns_half_a_turn() -> None:
    limit = found("revolute", 'lower="0" upper="0" velocity="1" effort="1"')
    assert limit.guessed == ("positions (no range in the URDF)",)
    assert (limit.limit.lower, limit.limit.upper) == pytest.approx((-3.14159, 3.14159))


@pytest.mark.parametrize("limit", ['lower="0" upper="0"', 'lower="1" upper="-1"', ""])
def test_a_slide_without_room_is_taken_as_fixed(limit: str) -> None:
    body = body_of(BASE, ARM, joint("j", "base_link", "arm", kind="prismatic", limit=limit))
    assert body.index == {}
    assert body.skeleton.rigid("base_link") == ("base_link", "arm")


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        ('velocity="-1"', "the joint j has velocity='-1'; write a number of 0 or more"),
        ('effort="inf"', "the joint j has effort='inf'; write a number$"),
        ('lower="nan"', "the joint j has lower='nan'; write a number$"),
        ('upper="1,5"', "the joint j has upper='1,5'; write a number$"),
    ],
)
def test_a_limit_that_is_no_number_is_told_with_its_joint(limit: str, words: str) -> None:
    with pytest.raises(SetupError, match=words):
        found("revolute", f'{limit} lower="-1"' if "lower" not in limit else limit)
