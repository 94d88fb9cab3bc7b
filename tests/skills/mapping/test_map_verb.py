"""`momantu-bt map`: a folder whole or not at all, and sentences for what is wrong."""

from __future__ import annotations

import json
import os
import resource
import signal

import numpy as np
import pytest
from momantu_skills.mapping import building
from momantu_skills.mapping import progress as shown
from momantu_skills.mapping.logs import carmen
from PIL import Image

from momantu_bt.cli import main
from momantu_bt.errors import ExitCode
from momantu_bt.formats.maps import OCCUPIED, read_map
from tests.skills.mapping.walls import ROUND, driven, logged


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """The log of a short way, as CARMEN writes it."""
    path = tmp_path_factory.mktemp("log") / "way.log"
    lines = []
    for scan in logged(driven(ROUND[:3], 0.5), 1):
        odom, rays = scan.odom_from_base, scan.rays
        laser = odom @ type(odom)(float(rays.origin[0]), 0.0)
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


def test_the_folder_holds_a_map_that_opens_again(log, tmp_path, capsys):
    out = tmp_path / "map"
    assert main(["map", "--log", str(log), "-o", str(out)]) == ExitCode.SUCCESS
    said = capsys.readouterr()
    assert "scans on" in said.out
    assert "of" in said.err
    assert {each.name for each in out.iterdir()} == {
        "map.yaml",
        "map.pgm",
        "map.png",
        "trajectory.tum",
        "report.json",
        "site.yaml",
        "survey.npz",
    }
    assert (read_map(out / "map.yaml").cells() == OCCUPIED).sum() > 100
    report = json.loads((out / "report.json").read_text())
    rows = np.loadtxt(out / "trajectory.tum")
    assert rows.shape == (report["scans_read"], 8)
    assert np.linalg.norm(rows[:, 4:], axis=1) == pytest.approx(1.0, abs=1e-6)
    with Image.open(out / "map.png") as picture:
        assert max(picture.size) >= 400
    again = tmp_path / "again"
    assert main(["map", "--log", str(log), "-o", str(again)]) == ExitCode.SUCCESS
    for each in out.iterdir():
        assert each.read_bytes() == (again / each.name).read_bytes()


def test_a_folder_with_files_is_refused(log, tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["map", "--log", str(log), "-o", str(tmp_path)]) == ExitCode.WRONG_INPUT
    assert "holds files already; choose another folder" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["mine.txt"]
    assert main(["map", "--log", str(log), "-o", str(tmp_path / "mine.txt")]) == 2
    assert "is a file; choose a folder" in capsys.readouterr().err


def test_what_cannot_be_written_is_told_before_the_work(log, tmp_path, capsys, monkeypatch):
    (tmp_path / "mine.txt").write_text("mine")
    monkeypatch.setattr(building, "build", lambda *_: pytest.fail("the log was mapped"))
    out = tmp_path / "mine.txt" / "map"
    assert main(["map", "--log", str(log), "-o", str(out)]) == ExitCode.WRONG_INPUT
    said = capsys.readouterr().err
    assert f"{out} cannot be written: {tmp_path / 'mine.txt'}: Not a directory" in said
    assert [each.name for each in tmp_path.iterdir()] == ["mine.txt"]


def test_a_full_disk_leaves_nothing(log, tmp_path, capsys):
    out, soft = tmp_path / "map", resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, soft[1]))
    try:
        assert main(["map", "--log", str(log), "-o", str(out)]) == ExitCode.WRONG_INPUT
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, soft)
    said = capsys.readouterr().err
    assert f"{out}/" in said
    assert "cannot be written: File too large" in said
    assert not list(tmp_path.iterdir())


def test_a_bad_log_writes_nothing(tmp_path, capsys):
    bad = tmp_path / "bad.log"
    bad.write_text("FLASER 1 2.0 0 0 0 0 0 0 1 h 1\n")
    assert main(["map", "--log", str(bad), "-o", str(tmp_path / "out")]) == ExitCode.WRONG_INPUT
    assert "a map needs 2 at least" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_ctrl_c_saves_what_there_is(log, tmp_path, capsys, monkeypatch):
    progress = shown.Scans.__call__

    def interrupted(self, done, loops):
        if done == 10:
            os.kill(os.getpid(), signal.SIGINT)
        return progress(self, done, loops)

    monkeypatch.setattr(shown.Scans, "__call__", interrupted)
    out = tmp_path / "map"
    assert main(["map", "--log", str(log), "-o", str(out)]) == ExitCode.INTERRUPTED
    assert json.loads((out / "report.json").read_text())["scans_read"] == 10
    assert "saving the map so far" in capsys.readouterr().err
    assert len(carmen.read_carmen(log).scans) > 10


@pytest.mark.parametrize("given", [[], ["--log", "a.log", "--world", "small_flat"]])
def test_it_wants_either_a_log_or_a_world(given, tmp_path, capsys):
    assert main(["map", *given, "-o", str(tmp_path / "map")]) == ExitCode.WRONG_INPUT
    assert "either --log with a log, or --world" in capsys.readouterr().err


def test_a_world_that_is_not_there_is_told_and_nothing_is_written(tmp_path, capsys):
    assert main(["map", "--world", "moon", "-o", str(tmp_path / "map")]) == ExitCode.WRONG_INPUT
    assert "no world is called 'moon'" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_log_is_not_mapped_in_three_dimensions(log, tmp_path, capsys):
    arguments = ["map", "--log", str(log), "--dimensions", "3", "-o", str(tmp_path / "out")]
    assert main(arguments) == ExitCode.WRONG_INPUT
    assert "leave out --dimensions 3" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_map_is_not_extended_in_three_dimensions(tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["--world", "any", "--dimensions", "3", "--extend", str(tmp_path), "-o", str(out)]
    assert main(["map", *arguments]) == 2
    assert "--extend goes on with a map in two dimensions" in capsys.readouterr().err
    assert not out.exists()
