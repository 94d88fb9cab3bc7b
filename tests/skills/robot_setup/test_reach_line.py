"""How far arms with few joints reach: where their hands also come and go straight."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_skills.robot_setup.find import reach as search
from momantu_skills.robot_setup.find.base import find_base, find_stand
from momantu_skills.robot_setup.find.limits import find_limits, plain_limits
from momantu_skills.robot_setup.find.reach import APPROACH, STEP, find_reach
from momantu_skills.robot_setup.urdf.arm_ik import LimbSolver
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.prepare import Placed, prepare

from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Transform
from tests.skills.robot_setup.conftest import box, joint, link

NEAREST, TRAVEL = 0.45, 0.5
"""Where a telescope's hand is when it is drawn in, and how far it comes out, m."""
JOINTS = ("lift", "out", "yaw")


def telescope(
    folder: Path, travel: float = TRAVEL, heights: tuple[float, float] = (0.2, 1.2)
) -> tuple[LimbSolver, Body]:
    """A column with a telescope whose hand turns about the vertical, and rises between heights."""
    slide = 'velocity="1" effort="30" lower="{}" upper="{}"'
    source = folder / "given.urdf"
    source.write_text(
        '<robot name="given">'
        + link("base", box(0.3, 0.3, 0.1), at="0 0 0.05", mass=20.0)
        + link("carriage", box(0.05, 0.05, 0.05))
        + link("rod", box(0.05, 0.05, 0.05))
        + link("hand", box(0.05, 0.05, 0.05))
        + joint("lift", "base", "carriage", kind="prismatic", limit=slide.format(*heights))
        + joint("out", "carriage", "rod", "0.2 0 0", "1 0 0", "prismatic", slide.format(0, travel))
        + joint("yaw", "rod", "hand", "0.05 0 0", limit=slide.format(-3, 3))
        + "</robot>"
    )
    prepared = prepare(source, folder)
    base = find_base(prepared.skeleton)
    body = Body(prepared.skeleton, Placed(prepared.urdf, base.frame))
    tree = KinematicTree.from_urdf(prepared.urdf, base.frame)
    limits = plain_limits(find_limits(body, JOINTS, ()))
    place = Transform((NEAREST - 0.25, 0.0, 0.0))
    return LimbSolver(tree, JOINTS, limits, "hand", place, seed=0), body


@pytest.fixture(autouse=True)
def straight_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    """One line of reach instead of 68: the search of lines takes its time."""
    monkeypatch.setattr(search, "HEADINGS", (0.0,))
    monkeypatch.setattr(search, "LATERALS", (0.0,))
    monkeypatch.setattr(search, "BREADTHS", (0.01,))
    monkeypatch.setattr(search, "FARTHEST", 1.2)


def test_a_telescope_has_room_to_go_back(tmp_path: Path) -> None:
    solver, body = telescope(tmp_path)
    found = find_reach(solver, find_stand(body))
    near, best, far = found.reach
    assert near == pytest.approx(NEAREST + APPROACH, abs=STEP)
    assert far == pytest.approx(NEAREST + TRAVEL, abs=STEP)
    assert near < best < far


def test_a_short_one_reaches_what_it_reaches(tmp_path: Path) -> None:
    solver, body = telescope(tmp_path, travel=APPROACH)
    near, _, far = find_reach(solver, find_stand(body)).reach
    assert near <= NEAREST
    assert far <= NEAREST + APPROACH + STEP


def test_a_turn_that_is_allowed_only_adds(tmp_path: Path) -> None:
    solver, _ = telescope(tmp_path)
    poses = np.array([Transform((x, 0.1, 0.6)).matrix for x in np.arange(0.2, 1.0, 0.1)])
    some, free = (solver.reaches(poses, 6, turn) for turn in (0.3, np.pi))
    assert not (some & ~free).any()
    assert free.sum() > some.sum()


def test_an_arm_that_reaches_no_usual_table_is_measured_on_others(tmp_path: Path) -> None:
    solver, body = telescope(tmp_path, heights=(0.1, 0.38))
    found = find_reach(solver, find_stand(body))
    assert found.measured
    assert found.tables == (0.1, 0.2, 0.3)
    near, _, far = found.reach
    assert near == pytest.approx(NEAREST + APPROACH, abs=STEP)
    assert far == pytest.approx(NEAREST + TRAVEL, abs=STEP)


def test_an_arm_that_reaches_one_height_alone_has_no_tables(tmp_path: Path) -> None:
    solver, body = telescope(tmp_path, heights=(0.25, 0.27))
    assert not find_reach(solver, find_stand(body)).measured
