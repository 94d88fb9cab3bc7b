"""Whether a body can have a mass and an inertia, and what to write when it cannot."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array, matrix_from_quaternion, quaternion_from_rpy
from momantu_bt.robots.inertia import DENSITY, impossible_inertials, inertia_problems

EDGE = st.floats(0.02, 1.0)
SHAPE = '<collision><geometry><box size="0.2 0.1 0.3"/></geometry></collision>'
MASSLESS = '<inertial><mass value="0"/></inertial>'


def robot(link: str, *, kind: str = "revolute") -> etree._Element:
    """A base, and a link with this text inside that hangs on a joint of this kind."""
    joint = f'<joint name="j" type="{kind}"><parent link="base"/><child link="part"/></joint>'
    text = f'<robot name="r"><link name="base"/><link name="part">{link}</link>{joint}</robot>'
    return etree.fromstring(text)


def inertial(mass: float, matrix: Array) -> str:
    values = " ".join(
        f'i{"xyz"[i]}{"xyz"[j]}="{float(matrix[i, j])!r}"' for i in range(3) for j in range(i, 3)
    )
    return f'<inertial><mass value="{mass!r}"/><inertia {values}/></inertial>'


@given(EDGE, EDGE, EDGE, st.floats(0.01, 50), st.tuples(*[st.floats(-3, 3)] * 3))
def test_every_solid_box_in_every_orientation_passes(
    x: float, y: float, z: float, mass: float, rpy: tuple[float, float, float]
) -> None:
    principal = mass / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])
    turned = matrix_from_quaternion(quaternion_from_rpy(*rpy))
    assert inertia_problems(robot(inertial(mass, turned @ principal @ turned.T) + SHAPE)) == []


@given(st.floats(0.01, 1), st.floats(0.01, 1), st.floats(1.02, 5))
def test_one_moment_larger_than_both_others_is_unlikely(a: float, b: float, more: float) -> None:
    (problem,) = inertia_problems(robot(inertial(1.0, np.diag([a, b, (a + b) * more]))))
    assert (problem.severity, problem.code) == (Severity.WARNING, "unlikely-inertia")


@pytest.mark.parametrize(
    ("inside", "code"),
    [
        (SHAPE, "no-inertia"),
        (MASSLESS + SHAPE, "no-inertia"),
        (MASSLESS.replace("0", "2") + SHAPE, "no-inertia"),
        (MASSLESS.replace("0", "-1"), "negative-mass"),
        (inertial(1.0, np.zeros((3, 3))), "bad-inertia"),
        (inertial(1.0, np.array([[1, 2, 0], [2, 1, 0], [0, 0, 1.0]])), "bad-inertia"),
    ],
)
def test_what_physics_would_invent_is_an_error_of_what_moves(inside: str, code: str) -> None:
    (moving,) = inertia_problems(robot(inside))
    (fixed,) = inertia_problems(robot(inside, kind="fixed"))
    assert (moving.severity, moving.code) == (Severity.ERROR, code)
    assert "'part'" in moving.message
    impossible = code == "negative-mass" or 'ixy="2.0"' in inside
    assert (fixed.severity is Severity.ERROR, fixed.code) == (impossible, code)


def test_massless_links_without_shape_are_frames() -> None:
    assert inertia_problems(robot("")) == []
    assert inertia_problems(robot(MASSLESS)) == []


@given(EDGE, EDGE, EDGE, st.tuples(*[st.floats(-1, 1)] * 3))
def test_what_is_proposed_passes_and_weighs_its_box(
    x: float, y: float, z: float, at: tuple[float, float, float]
) -> None:
    origin = f'<origin xyz="{" ".join(str(v) for v in at)}"/>'
    shape = f'<collision>{origin}<geometry><box size="{x} {y} {z}"/></geometry></collision>'
    (problem,) = inertia_problems(robot(shape))
    proposed = problem.hint[problem.hint.index("<") : problem.hint.rindex(">") + 1]
    assert inertia_problems(robot(proposed + shape)) == []
    (mass,) = etree.fromstring(proposed).iter("mass")
    (center,) = etree.fromstring(proposed).iter("origin")
    assert float(mass.get("value", "")) == pytest.approx(DENSITY * x * y * z, rel=1e-3)
    told = [float(v) for v in center.get("xyz", "").split()]
    assert told == pytest.approx(at, rel=1e-3, abs=1e-6)


def test_the_box_surrounds_cylinders_and_spheres_as_they_lie() -> None:
    lying = '<origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/>'
    cylinder = '<geometry><cylinder radius="0.1" length="2"/></geometry>'
    sphere = '<geometry><sphere radius="0.5"/></geometry>'
    shapes = f"<collision>{lying}{cylinder}</collision><collision>{sphere}</collision>"
    (problem,) = inertia_problems(robot(shapes))
    assert f'mass value="{DENSITY * 2 * 1 * 1.6:.4g}"' in problem.hint
    assert 'origin xyz="0 0 0.3"' in problem.hint


def test_of_a_mesh_the_formula_is_given() -> None:
    mesh = '<collision><geometry><mesh filename="x.stl"/></geometry></collision>'
    (problem,) = inertia_problems(robot(mesh))
    assert "ixx = m/12 (y*y + z*z)" in problem.hint


def test_a_fixed_link_may_have_no_inertia_but_no_impossible_one() -> None:
    (none,) = inertia_problems(robot(inertial(1.0, np.zeros((3, 3))), kind="fixed"))
    assert (none.code, none.severity) == ("bad-inertia", Severity.WARNING)
    (negative,) = inertia_problems(robot(inertial(1.0, np.diag([-1e-3, 1, 1])), kind="fixed"))
    assert (negative.code, negative.severity) == ("bad-inertia", Severity.ERROR)
    assert list(impossible_inertials(robot(inertial(1.0, np.diag([-1e-3, 1, 1])), kind="fixed")))
