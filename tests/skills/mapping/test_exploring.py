"""`momantu-bt map --world`: the tree runs, and what there is is saved however it ends."""

from __future__ import annotations

import os
import signal

import pytest
from momantu_skills.mapping import exploring, results

from momantu_bt.site_file import read_names
from momantu_bt.testing import ScriptedWorld, scripted_site
from tests.skills.scenery.flat import DESK, ROOMS, START, FlatRobot


@pytest.fixture
def flat_world():
    robot = FlatRobot(START)
    robot.boxes = [*ROOMS, DESK]
    robot.dead.add("wrench")
    return ScriptedWorld(robot, scripted_site(start=START))


def test_the_flat_is_explored_and_saved(flat_world, tmp_path):
    told = []
    out = tmp_path / "flat"
    explored = exploring.explore(
        flat_world, None, 0, out, lambda now, mapping: told.append((now, mapping.known))
    )
    assert (explored.status, explored.why) == ("SUCCESS", "")
    assert explored.about["free_m2"] > 55.0
    assert {each.name for each in out.iterdir()} == results.FILES
    assert list(read_names(out / "site.yaml").places) == ["start"]
    assert told[-1][1] > 55.0


@pytest.mark.parametrize(("end", "status"), [("interrupt", "INTERRUPTED"), ("stuck", "FAILURE")])
def test_what_there_is_is_saved_when_it_ends_early(flat_world, tmp_path, end, status):
    def disturb(now, mapping):
        if now > 5.0 and end == "interrupt":
            os.kill(os.getpid(), signal.SIGINT)
        elif now > 5.0:
            flat_world.robot.frozen.add("base")

    explored = exploring.explore(flat_world, None, 0, tmp_path / "flat", disturb)
    assert explored.status == status
    assert bool(explored.why) == (end == "stuck")
    assert explored.about["free_m2"] > 5.0
    assert {each.name for each in (tmp_path / "flat").iterdir()} == results.FILES
