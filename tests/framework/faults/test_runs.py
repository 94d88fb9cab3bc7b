"""Faults in whole runs: when they begin and end, whom they hit, and what is refused."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys

import numpy as np
import pytest

from momantu_bt.fault import FaultError
from momantu_bt.faults.director import Director
from momantu_bt.faults.effects.site import wrong_site
from momantu_bt.faults.effects.skills.modes import without_numbers
from momantu_bt.faults.spec import parse_fault
from momantu_bt.formats.maps import FREE, OCCUPIED, read_map
from momantu_bt.geometry import Transform
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import ExampleWorld, ScriptedWorld, scripted_site
from momantu_bt.world import TICK

DRIVE = "  Main: [{drive: {ticks: 40}}]\n"
TWICE = "  Main: [{drive: {ticks: 10}, repeat: 3}, Again]\n  Again: [drive]\n"
FIND = "  Main: [{detect: {seen: $a, sizes: $b, count: $c}}, {approach: {pose: $a}}]\n"
RETRY = "  Main: [{detect: {seen: $a, sizes: $b, count: $c}, retry: 3}]\n"


def spans(report):
    return [(fault.began, fault.ended) for fault in report.faults]


def ticks(number):
    return pytest.approx(number * TICK)


@pytest.mark.parametrize(
    ("phase", "began"),
    [
        ("start", 0),
        ("0.2 s", 4),
        ("drive", 1),
        ("drive+0.2 s", 5),
        ("drive/driving", 4),
        ("drive/driving+100 ms", 6),
        ("Main/d*", 1),
        ("drive#2", None),
        ("drive/landing", None),
        ("after-drive", None),  # it ends with the run: there is no tick after it
        ("5 s", None),
    ],
)
def test_when_a_fault_begins(run_tree, phase, began):
    report = run_tree(DRIVE, f"base.slow@{phase}")
    assert spans(report) == [(None if began is None else ticks(began), None)]
    assert report.status == "SUCCESS"


@pytest.mark.parametrize(
    ("phase", "began"),
    [
        ("drive#3", 21),
        ("drive/driving#2", 14),
        ("after-drive", 11),
        ("after-drive#3", 31),
        ("after-repeat+0.1 s", 33),
        ("Again/drive", 31),
        ("Again", 31),
        ("repeat", 1),
    ],
)
def test_second_times_and_ends(run_tree, phase, began):
    assert spans(run_tree(TWICE, f"base.slow@{phase}")) == [(ticks(began), None)]


def test_a_fault_lasts_as_long_as_it_says(run_tree):
    world = ScriptedWorld()
    places = []
    world._on_step = lambda robot: places.append(robot.linear)
    report = run_tree(DRIVE, "base.stuck@0.5 s:for=1 s", world=world)
    assert spans(report) == [(ticks(10), ticks(30))]
    assert places[9] > 0.4
    assert places[25:30] == [0.0] * 5
    assert places[35] > 0.0
    assert report.faults[0].fault == "base.stuck@0.5 s:for=1.0"
    assert json.loads(json.dumps(report.as_dict()))["faults"] == [
        {"fault": "base.stuck@0.5 s:for=1.0", "began": ticks(10), "ended": ticks(30)}
    ]


def test_what_is_mended_after_the_end_is_mended_while_all_comes_to_rest(run_tree):
    report = run_tree(DRIVE, "base.slow@1.9 s:for=0.5 s", "base.slow@2.2 s")
    assert spans(report) == [(ticks(38), ticks(48)), (None, None)]


def test_the_same_run_with_and_without_a_fault_that_does_nothing_and_twice_with_one(run_tree):
    plain, wide, *broken = (
        run_tree(DRIVE, *faults).fingerprint
        for faults in ((), ("base.slow@drive#2",), ("base.slow",), ("base.slow",))
    )
    assert plain == wide
    assert broken[0] == broken[1] != plain


def test_the_robot_that_tree_and_services_see_is_the_broken_one(run_tree):
    seen = "  Main: [{drive: {ticks: 20}}, {set: {key: $far, value: $@robot.linear}}]\n"
    world = ScriptedWorld()
    report = run_tree(seen, "odometry.slip@start:scale=2,for=inf", world=world)
    assert report.blackboard["far"] == pytest.approx(2 * 0.5)


class Clumsy(ScriptedWorld):
    """A world that can break: it moves the base, but not before 0.5 s."""

    def faults(self):
        return ("robot.kidnapped", "object.removed")

    def effect(self, fault):
        if fault.name != "robot.kidnapped":
            raise FaultError("no object is here")
        return _Kidnapped(self, float(fault.parameters["distance"]))


class _Kidnapped:
    def __init__(self, world, distance):
        self.world, self.distance = world, distance

    def begin(self):
        if self.world.now() < 0.5 - 1e-9:
            raise FaultError("not yet")
        from dataclasses import replace

        base = self.world.robot.base
        self.world.robot.base = replace(base, y=base.y + self.distance)

    def end(self):
        raise AssertionError("it does not last")


def test_a_fault_of_the_world_is_tried_again_until_it_can_happen(run_tree):
    world = Clumsy()
    report = run_tree(DRIVE, "robot.kidnapped@drive:distance=3 m", world=world)
    assert spans(report) == [(ticks(10), None)]
    assert world.robot.base.y == pytest.approx(3.0)


def test_what_nothing_implements_is_refused_before_the_first_tick(run_tree, tmp_path):
    def refused(said, *faults, tree=DRIVE, **more):
        with pytest.raises(FaultError, match=said):
            run_tree(tree, *faults, **more)

    wait = "  Main: [{wait: 1 s}]\n"
    refused("world scripted cannot make tag.covered; there are no faults", "tag.covered")
    refused(
        "cannot make tag.covered; faults of the world's own: robot", "tag.covered", world=Clumsy()
    )
    refused("no object is here", "object.removed", world=Clumsy())
    refused("the tree runs no skill", "skill.hang", tree=wait)
    refused("this run has no world", "camera.dead", tree=wait, world="none")
    refused("this run has no world", "base.stuck", world="none")
    refused("no node that runs is called 'drove'; did you mean drive", "base.stuck@drove")
    refused("takes no phase 'drive'", "table.height@drive")
    refused("no surface 'table_c'; did you mean table_", "table.height:surface=table_c")
    refused("below the floor", "table.height:by=-0.9")
    refused("no surface 'table_c'", "table.moved:surface=table_c")
    refused("scripted has no floor plan", "map.wrong")
    refused("did you mean base", "bse.stuck")
    report = run_tree(wait, "process.killed@5 s", world="none")
    assert spans(report) == [(None, None)]


# skills


def test_an_exception_in_a_skill_fails_its_leaf_once(run_tree):
    report = run_tree(DRIVE, "skill.exception")
    assert report.failure.code == "SKILL_ERROR"
    assert "skill.exception was asked for" in report.failure.message
    assert report.sim_time_s == ticks(2)
    assert run_tree(RETRY, "skill.exception").status == "SUCCESS"
    assert run_tree(RETRY, "skill.exception:times=2").status == "SUCCESS"
    assert run_tree(RETRY, "skill.exception:times=3").status == "FAILURE"


@pytest.mark.parametrize(
    ("phase", "failed"),
    [
        ("start", "detect"),
        ("0.1 s", "detect"),
        ("Main", "detect"),
        ("detect/measuring", "detect"),
        ("after-detect", "approach"),
        ("approach", "approach"),
    ],
)
def test_which_skill_is_hit(run_tree, phase, failed):
    report = run_tree(FIND, f"skill.exception@{phase}")
    assert [node.type for node in report.nodes if node.failures][-1] == failed


def test_a_nan_and_a_wrong_type_are_refused_before_anybody_moves_by_them(run_tree):
    for name in ("skill.nan", "skill.wrong_type"):
        world = ScriptedWorld()
        report = run_tree(FIND, name, world=world)
        assert report.failure.code == "WRONG_TYPE", name
        assert "seen" in report.failure.message
        assert report.blackboard == {}
        assert world.robot.base.x == 0.0
        assert run_tree(RETRY, name).status == "SUCCESS"
    assert run_tree(DRIVE, "skill.nan").status == "SUCCESS"  # it has no outputs


def test_a_slow_skill_takes_longer_by_both_clocks(run_tree):
    usual = run_tree(DRIVE)
    slow = run_tree(DRIVE, "skill.slow@drive:wall=25 ms,factor=3,for=0.5 s")
    assert slow.status == "SUCCESS"
    assert slow.sim_time_s > usual.sim_time_s + 0.3
    assert 2 <= slow.nodes[1].slow_ticks <= 8
    assert slow.nodes[1].slowest_s >= 0.025


def test_a_hanging_skill_fails_with_hung_and_the_tree_goes_on(run_tree):
    report = run_tree(RETRY, "skill.hang", patience=0.3)
    assert report.status == "SUCCESS"
    assert report.nodes[-1].failures == 1
    report = run_tree(RETRY, "skill.hang:times=3", patience=0.2)
    assert report.failure.code == "HUNG"
    assert "before" in report.failure.data["traceback"]


class Careless(Skill):
    """Goes on whatever happens, and closes what it opened."""

    closed: list[str] = []

    def run(self, robot) -> Run:
        try:
            for _ in range(3):
                yield "working"
        finally:
            self.closed.append("closed")


def test_a_skill_that_is_hit_closes_what_it_opened(run_tree):
    for name in ("skill.exception", "skill.hang"):
        Careless.closed.clear()
        run_tree("  Main: [careless]\n", name, skills={"careless": Careless}, patience=0.3)
        assert Careless.closed == ["closed"]


def test_numbers_are_lost_wherever_they_are():
    lost = without_numbers(((1.0, 2, "a"), Transform((1, 2, 3), (0, 1, 0, 0)), None))
    assert math.isnan(lost[0][0])
    assert lost[0][1:] == (2, "a")
    assert all(map(math.isnan, lost[1].position))
    assert lost[1].quaternion.tolist() == [0, 1, 0, 0]


# what the robot is told


class Spy(Skill):
    """Reads the site."""

    heard: list[object] = []

    def run(self, robot) -> Run:
        self.heard.append(self.site)
        yield "reading"
        self.heard.append(self.site.map_file and self.site.map_file.read_text())


def test_surfaces_are_told_too_high(run_tree):
    def heights(*faults):
        Spy.heard.clear()
        world = ScriptedWorld()
        report = run_tree("  Main: [spy]\n", *faults, world=world, skills={"spy": Spy})
        assert all(span == (0.0, None) for span in spans(report))
        assert world.site.surfaces["table_a"].height == 0.7
        return [surface.height for surface in Spy.heard[0].surfaces.values()]

    assert heights("table.height:by=10 cm") == pytest.approx([0.8, 0.6])
    assert heights("table.height:by=-10 cm,surface=table_b") == pytest.approx([0.7, 0.4])
    assert heights("table.height", "table.height:by=1 cm") == pytest.approx([0.76, 0.56])


def test_tables_are_told_elsewhere_and_drawn_there(run_tree):
    maps = []

    class Reader(Spy):
        """Reads the map."""

        def run(self, robot) -> Run:
            maps.append(read_map(self.site.map_file))
            yield from super().run(robot)

    def told(fault, seed=0):
        Spy.heard.clear()
        maps.clear()
        world = ExampleWorld()
        true = world.site.surfaces
        before = read_map(world.site.map_file)
        run_tree("  Main: [spy]\n", fault, world=world, skills={"spy": Reader}, seed=seed)
        return true, Spy.heard[0].surfaces, before, maps[0]

    true, now, before, after = told("table.moved:surface=table_a,distance=40 cm,turn=0.2")
    here, there = true["table_a"].map_from_surface, now["table_a"].map_from_surface
    assert here.distance_to(there) == pytest.approx(0.4)
    assert here.yaw - there.yaw == pytest.approx(0.2)
    assert now["table_b"] == true["table_b"]
    assert (after.occupied() != before.occupied()).any()
    changed = np.argwhere(after.occupied() != before.occupied())[:, ::-1] * after.resolution
    x = after.origin[0] + changed[:, 0]
    y = after.origin[1] + len(after.levels) * after.resolution - changed[:, 1]
    assert (
        np.hypot(x - here.x, y - here.y).max() < 0.4 + math.hypot(*true["table_a"].size) / 2 + 0.2
    )
    again = told("table.moved:surface=table_a,distance=40 cm", seed=1)[1]["table_a"]
    assert again.map_from_surface.distance_to(there) > 0.01, "another seed, another direction"


def test_a_wrong_map_lacks_a_wall_or_lies_elsewhere(run_tree):

    def maps_of(fault, seed=0):
        Spy.heard.clear()
        maps = []
        world = ExampleWorld()

        class Reader(Spy):
            """Reads the map."""

            def run(self, robot) -> Run:
                maps.append(read_map(self.site.map_file))
                yield from super().run(robot)

        run_tree("  Main: [reader]\n", fault, world=world, skills={"reader": Reader}, seed=seed)
        maps.append(read_map(world.site.map_file))
        world.close()
        assert not Spy.heard[0].map_file.exists()
        return maps

    wrong, right = maps_of("map.wrong:missing=1 m")
    differ = wrong.cells() != right.cells()
    assert 0 < differ.sum() <= 21 * 21
    assert (right.cells()[differ] == OCCUPIED).all()
    assert (wrong.cells()[differ] == FREE).all()
    assert wrong.origin == right.origin
    assert (maps_of("map.wrong:missing=1 m")[0].cells() == wrong.cells()).all()
    assert (maps_of("map.wrong:missing=1 m", seed=1)[0].cells() != wrong.cells()).any()
    wrong, right = maps_of("map.wrong:missing=0,shift=50 cm")
    assert (wrong.cells() == right.cells()).all()
    away = (wrong.origin[0] - right.origin[0], wrong.origin[1] - right.origin[1])
    assert math.hypot(*away) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("header", "kind"),
    [(b"P5 3 3 65535\n", ">u2"), (b"P2\n# plain\n3 3 100\n", ""), (b"P5 3 3 1 ", "u1")],
)
def test_every_map_that_a_robot_can_drive_on_can_be_made_wrong(tmp_path, header, kind):
    brightest = int(header.split()[-1])
    levels = np.full((3, 3), brightest)
    levels[1, 1] = 0
    body = levels.astype(kind).tobytes() if kind else " ".join(map(str, levels.ravel())).encode()
    (tmp_path / "map.pgm").write_bytes(header + body)
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    site = scripted_site(map_file=tmp_path / "map.yaml")
    out = tmp_path / "out"
    out.mkdir()
    wrong = read_map(wrong_site(site, parse_fault("map.wrong:missing=0.1 m"), 0, out).map_file)
    assert (read_map(site.map_file).cells() == OCCUPIED).sum() == 1
    assert (wrong.cells() == FREE).all()
    assert wrong.brightest == brightest


# the process


def test_a_killed_process_leaves_a_report_that_says_so(tmp_path):
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\nmain: Main\ntrees:\n  Main: [{wait: 1 min}]\n")
    report = tmp_path / "report.json"
    words = ["run", str(tree), "--fault", "process.killed@1 s", "--report", str(report)]
    ended = subprocess.run([sys.executable, "-m", "momantu_bt", *words], capture_output=True)
    assert ended.returncode == -signal.SIGKILL
    left = json.loads(report.read_text())
    assert (left["status"], left["success"]) == ("ERROR", None)


def test_an_observer_sees_the_tick_before_a_fault_changes_anything(run_tree, monkeypatch):
    told, act = [], Director.act

    def acting(director, context, settling=False):
        act(director, context, settling)
        told.append((round(context.now, 3), director.reports()[0].began))

    class Watching:
        def ticked(self, run):
            told.append((round(run.context.now, 3), "seen"))

        def close(self):
            pass

    monkeypatch.setattr(Director, "act", acting)
    run_tree(DRIVE, "base.stuck@0.5 s", watch=lambda run: [Watching()])
    at = told.index((0.5, "seen"))
    assert told[at - 1] == (0.45, None)
    assert told[at + 1] == (0.5, ticks(10))
