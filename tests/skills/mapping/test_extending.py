"""Going on with a saved map: nothing is forgotten, frames stay, and bad folders are told."""

from __future__ import annotations

import json
import os
import signal
from dataclasses import replace

import numpy as np
import pytest
from momantu_skills.mapping import building, exploring, extending, results, stored

from momantu_bt.cli import main
from momantu_bt.errors import InputError
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_bt.site_file import Names, TaughtSurface, read_names
from momantu_bt.testing import ScriptedWorld, scripted_site
from tests.skills.mapping.plans import drawn, written
from tests.skills.mapping.walls import ROUND, box, driven, error, logged
from tests.skills.scenery.flat import DESK, ROOMS, START, FlatRobot

WAY = driven(ROUND[:4], 0.5)
BACK = driven([(14.0, 10.4), (1.5, 10.4), (1.5, 1.5), (4.0, 1.5)], 0.5)
NAMES = Names(
    start=(0.0, 0.0, 0.0),
    places={"corner": (12.5, 0.0, 1.0)},
    surfaces={
        "bench": TaughtSurface(centre=(6.0, -0.8, 0.0), size=(1.0, 0.4), height=0.5, sides=(0,))
    },
)


def never(done, loops):
    return False


def carmen(path, scans):
    """A log as CARMEN writes it."""
    lines = []
    for scan in scans:
        odom, rays = scan.odom_from_base, scan.rays
        laser = odom @ Pose2D(float(rays.origin[0]), 0.0)
        ranges = [
            round(float(r), 3) if hit else 30.0
            for r, hit in zip(rays.ranges, rays.hit, strict=True)
        ]
        head = ["ROBOTLASER1", 0, -np.radians(110), 3.84, np.radians(1), 30.0, 0.01, 0, len(ranges)]
        poses = [laser.x, laser.y, laser.yaw, odom.x, odom.y, odom.yaw]
        tail = [0, *poses, 0, 0, 0, 0, 0, scan.stamp, "h", scan.stamp]
        lines.append(" ".join(map(str, [*head, *ranges, *tail])))
    path.write_text("\n".join(lines))
    return path


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """A map of three sides of the building, with names."""
    folder = tmp_path_factory.mktemp("first") / "map"
    building.write(folder, building.build(logged(WAY, 1), 0.05, never), NAMES)
    return folder


def contents(folder):
    return {each.name: each.read_bytes() for each in folder.iterdir()}


def test_a_survey_reads_back_as_the_same_bytes(first):
    earlier = extending.read_earlier(first)
    assert stored.packed(earlier.known) == (first / results.SURVEY).read_bytes()
    built = building.build(logged(WAY, 1), 0.05, never).survey.known().graph
    graph = earlier.known.graph
    assert graph.poses == built.poses
    assert graph.loops == built.loops
    assert graph.motions == built.motions
    assert set(graph.finished) == set(built.finished)
    for number, submap in built.finished.items():
        assert graph.finished[number].points == pytest.approx(submap.points, abs=1e-5)


def test_a_log_is_added_wherever_it_begins(first, tmp_path, capsys):
    before = contents(first)
    log = carmen(tmp_path / "back.log", logged(BACK, 7))
    out = tmp_path / "more"
    assert main(["map", "--log", str(log), "--extend", str(first), "-o", str(out)]) == 0
    assert "the log begins at (12.5" in capsys.readouterr().out
    assert contents(first) == before
    report = json.loads((out / "report.json").read_text())
    assert report["sessions"] == 2
    assert report["scans"] == len(WAY) + len(BACK)
    known = extending.read_earlier(out).known
    assert error(known.graph.poses, [*WAY, *BACK]) < 0.03
    stamps = [scan.stamp for scan in known.read]
    assert stamps == sorted(stamps)
    assert len(np.loadtxt(out / "trajectory.tum")) == len(stamps)
    names = read_names(out / "site.yaml")
    assert names.places["corner"] == pytest.approx(NAMES.places["corner"], abs=0.05)
    assert names.surfaces["bench"].centre == pytest.approx((6.0, -0.8, 0.0), abs=0.05)
    once_more = tmp_path / "again"
    assert main(["map", "--log", str(log), "--extend", str(first), "-o", str(once_more)]) == 0
    assert contents(out) == contents(once_more)


def test_the_folder_itself_is_written_only_if_it_is_named(tmp_path, first, capsys):
    folder = tmp_path / "own"
    building.write(folder, building.build(logged(WAY, 1), 0.05, never), NAMES)
    log = carmen(tmp_path / "back.log", logged(BACK, 7))
    assert main(["map", "--log", str(log), "--extend", str(folder)]) == 2
    assert "give -o" in capsys.readouterr().err
    assert main(["map", "--log", str(log), "--extend", str(folder), "-o", str(first)]) == 2
    assert "holds files already" in capsys.readouterr().err
    assert main(["map", "--log", str(log), "--extend", str(folder), "-o", str(folder)]) == 0
    assert json.loads((folder / "report.json").read_text())["sessions"] == 2


@pytest.mark.parametrize("wide", [5, 9])
def test_a_log_of_another_place_is_not_added(first, tmp_path, capsys, wide):
    walls = [*box(0, 0, wide, 5), *box(1, 3, 0.7, 0.7), *box(wide - 3, 1, 0.7, 0.7)]
    way = driven([(2.5, 1.0), (3.5, 1.0), (3.5, 4.0)], 0.3)
    log = carmen(tmp_path / "other.log", logged(way, 3, walls))
    out = tmp_path / "more"
    assert main(["map", "--log", str(log), "--extend", str(first), "-o", str(out)]) == 2
    assert "the log shows no place of" in capsys.readouterr().err
    assert not out.exists()


def test_a_foreign_map_cannot_be_extended(tmp_path, capsys):
    folder = tmp_path / "foreign"
    folder.mkdir()
    written(drawn(box(0, 0, 5, 5)), folder / "map.yaml")
    for path in (folder, folder / "map.yaml"):
        given = ["map", "--world", "moon", "--extend", str(path), "-o", str(tmp_path / "out")]
        assert main(given) == 2
        assert "no survey.npz beside the map" in capsys.readouterr().err


@pytest.mark.parametrize(
    "damage", ["cut off", "empty", "text", "zeros within", "version", "lacking"]
)
def test_a_damaged_survey_is_told(first, tmp_path, damage):
    folder = tmp_path / "map"
    folder.mkdir()
    for name, content in contents(first).items():
        (folder / name).write_bytes(content)
    survey = folder / results.SURVEY
    whole = survey.read_bytes()
    with np.load(survey) as file:
        arrays = {name: file[name] for name in file.files}
    if damage == "version":
        np.savez_compressed(survey, **{**arrays, "version": np.array(99)})
    elif damage == "lacking":
        np.savez_compressed(survey, version=np.array(1))
    else:
        half = len(whole) // 2
        cut = {"cut off": whole[:half], "empty": b"", "text": b"nothing"}
        cut["zeros within"] = whole[:half] + bytes(50) + whole[half + 50 :]
        survey.write_bytes(cut[damage])
    said = "of version 99" if damage == "version" else "damaged"
    with pytest.raises(InputError, match=said):
        extending.read_earlier(folder)


def test_a_robot_finds_itself_near_where_it_is_told(first):
    earlier = extending.read_earlier(first)
    scan = logged([WAY[0]], 5)[0]
    off = Pose2D(0.6, -0.5, 0.3)
    found = extending.begun_at(earlier, off, scan.rays)
    assert found.distance_to(Pose2D(0.0, 0.0)) < 0.05
    assert abs(found.yaw) < 0.02
    with pytest.raises(Failure, match="does not fit the map") as failure:
        extending.begun_at(earlier, Pose2D(60.0, 40.0), scan.rays)
    assert failure.value.code == "NOT_LOCALIZED"
    blind = replace(scan.rays, hit=np.zeros_like(scan.rays.hit))
    with pytest.raises(Failure):
        extending.begun_at(earlier, off, blind)


def flat_world(start=START):
    robot = FlatRobot(start)
    robot.boxes = [*ROOMS, DESK]
    robot.dead.add("wrench")
    return ScriptedWorld(robot, scripted_site(start=START))


def test_an_exploration_goes_on_with_what_is_known(tmp_path):
    known = []

    def soon(now, mapping):
        known.append(mapping.known)
        if now > 5.0:
            os.kill(os.getpid(), signal.SIGINT)

    part, out = tmp_path / "part", tmp_path / "whole"
    ended = exploring.explore(flat_world(), None, 0, part, soon)
    assert ended.status == "INTERRUPTED"
    before = contents(part)
    told = []
    moved = Pose2D(START.x + 0.2, START.y - 0.15, START.yaw + 0.1)
    explored = exploring.explore(
        flat_world(moved),
        None,
        0,
        out,
        lambda now, mapping: told.append(mapping.known),
        extending.read_earlier(part),
    )
    assert (explored.status, explored.why) == ("SUCCESS", "")
    assert explored.begun.distance_to(moved) < 0.05
    assert told[0] > 0.95 * ended.about["free_m2"]
    assert explored.about["free_m2"] > 55.0
    assert explored.about["sessions"] == 2
    assert contents(part) == before
    names = read_names(out / "site.yaml")
    assert names.places["start"] == pytest.approx(
        read_names(part / "site.yaml").places["start"], abs=0.05
    )


def test_a_robot_that_does_not_find_itself_writes_nothing(first, tmp_path):
    earlier = extending.read_earlier(first)
    explored = exploring.explore(
        flat_world(), None, 0, tmp_path / "out", lambda now, mapping: None, earlier
    )
    assert explored.about is None
    assert "does not fit the map" in explored.why
    assert not (tmp_path / "out").exists()
