"""What a run leaves behind: files that are whole, a report of a known form, a log with reasons."""

from __future__ import annotations

import json
import math
import os
import subprocess
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.failure import FailureValue
from momantu_bt.formats import files
from momantu_bt.formats.files import OutputError, check_writable, write_whole
from momantu_bt.geometry import Pose2D
from momantu_bt.record.folder import prepare_folder
from momantu_bt.record.report import FalseClaim, NodeReport, Report, SkillClaims
from momantu_bt.record.text.failure import failure_line

FIELDS = {
    "tree": str,
    "world": str,
    "robot": str,
    "seed": int,
    "status": str,
    "success": bool,
    "failure": dict,
    "unmet": list,
    "measures": dict,
    "sim_time_s": float,
    "wall_time_s": float,
    "start_time_s": float,
    "real_time_factor": float,
    "ticks": int,
    "blackboard": dict,
    "nodes": list,
    "fingerprint": str,
    "versions": dict,
    "error": str,
    "incidents": list,
    "demands": list,
    "causes": dict,
    "claims": dict,
    "faults": list,
    "interrupted_by": str,
    "remarks": list,
    "lost": list,
}
MAY_BE_NULL = ("world", "robot", "success", "failure", "error", "claims", "interrupted_by")

FAILURES = st.deferred(
    lambda: st.builds(
        FailureValue,
        st.sampled_from(["LOST", "PATH_BLOCKED"]),
        st.text(max_size=5),
        st.dictionaries(st.text(max_size=3), PLAIN, max_size=2).map(MappingProxyType),
        st.sampled_from(["", "navigate", "Put"]),
        st.sampled_from(["", "t.yaml:3", "/far/away/u.yaml:12"]),
        st.none() | FAILURES,
        st.lists(FAILURES, max_size=1).map(tuple),
        st.integers(0, 3),
        st.integers(-1, 3),
    )
)
PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=3)
    | st.just(Pose2D(1.0, math.nan, math.inf))
    | st.just(np.array([[1.0, math.nan], [math.inf, 2.0]]))
    | st.just(np.float32(2.5))
    | st.just(object),
    lambda inner: (
        st.lists(inner, max_size=2).map(tuple)
        | st.dictionaries(st.text(max_size=2) | st.integers(), inner, max_size=2)
    ),
    max_leaves=4,
)
REPORTS = st.builds(
    Report,
    tree=st.text(max_size=4),
    world=st.none() | st.just("four_rooms"),
    robot=st.none() | st.just("fetch"),
    seed=st.integers(0, 2**40),
    status=st.sampled_from(["SUCCESS", "FAILURE", "INTERRUPTED", "ERROR"]),
    success=st.none() | st.booleans(),
    failure=st.none() | FAILURES,
    unmet=st.lists(st.text(max_size=3), max_size=2).map(tuple),
    measures=st.dictionaries(st.text(max_size=3), st.floats(), max_size=2),
    sim_time_s=st.floats(0, 1e4),
    wall_time_s=st.sampled_from([0.0, 0.5, 20.0]),
    start_time_s=st.floats(0, 10),
    ticks=st.integers(0, 10**6),
    blackboard=st.dictionaries(st.text(max_size=3), PLAIN, max_size=2),
    nodes=st.just((NodeReport("a", "wait", "t.yaml:1", 3, 1, 0, 0.1),)),
    fingerprint=st.just("0" * 64),
    error=st.none() | st.just("Traceback …"),
    claims=st.none()
    | st.just({"pick": SkillClaims(2, 1, 1, 1, lies=(FalseClaim(0.1, "t:1", None, "held"),))}),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("reports")


@given(report=REPORTS)
def test_every_report_is_strict_json_of_one_form(folder, report):
    report.write(folder / "report.json")
    read = json.loads(
        (folder / "report.json").read_text(encoding="utf-8"), parse_constant=pytest.fail
    )
    assert list(read) == list(FIELDS)
    for name, kind in FIELDS.items():
        assert isinstance(read[name], kind) or (name in MAY_BE_NULL and read[name] is None), name
    assert read["status"] == report.status
    assert read["seed"] == report.seed
    link, told = report.failure, read["failure"]
    while link is not None:
        assert (told["code"], told["place"], told["tries"]) == (link.code, link.place, link.tries)
        assert len(told["beside"]) == len(link.beside)
        link, told = link.cause, told["cause"]
    assert told is None
    assert [entry.name for entry in folder.iterdir()] == ["report.json"]


@given(failure=FAILURES)
def test_a_chain_in_one_line_names_every_node_and_every_code(failure):
    line = failure_line(failure)
    assert line.startswith(str(failure))
    for link in failure.chain():
        assert link.node in line
        assert link.code in line
        assert link.place.rpartition(":")[2] in line
    assert line.count(" <- ") >= len(list(failure.chain()))


def test_a_place_in_another_file_is_written_with_its_name():
    inner = FailureValue("LOST", "", {}, "pick", "/lib/take.yaml:9")
    middle = FailureValue("LOST", "", {}, "Take", "/home/main.yaml:5", inner)
    outer = FailureValue("LOST", "", {}, "Main", "/home/main.yaml:2", middle)
    assert failure_line(outer) == "LOST <- Main (main.yaml:2) <- Take (:5) <- pick (take.yaml:9)"


def test_a_write_that_fails_leaves_what_was_there(tmp_path, monkeypatch):
    target = tmp_path / "report.json"
    write_whole(target, "before")

    def full(self, other):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(type(target), "replace", full)
    with pytest.raises(OutputError, match="No space left"):
        write_whole(target, "after")
    assert target.read_text() == "before"
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.json"]


def below_a_file(folder):
    (folder / "file").write_text("x")
    return folder / "file" / "report.json"


@pytest.mark.parametrize(
    "place",
    [
        below_a_file,
        lambda folder: folder / ("x" * 300),
        lambda folder: folder / "none" / "report.json",
        lambda folder: folder,
    ],
    ids=["below a file", "too long", "no folder", "a folder"],
)
def test_what_cannot_be_written_is_said_before_and_after_in_one_sentence(tmp_path, place):
    path = place(tmp_path)
    before = sorted(tmp_path.iterdir())
    with pytest.raises(OutputError, match=r"\S+ (cannot be written|is a folder)") as refused:
        check_writable(path)
    assert str(refused.value).count("cannot be written") <= 1
    with pytest.raises(OutputError, match="cannot be written"):
        write_whole(path, "text")
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("letter", ["x", "é", "木"])
def test_the_longest_name_there_can_be_is_written(tmp_path, letter):
    path = tmp_path / (letter * (255 // len(letter.encode())))
    check_writable(path)
    write_whole(path, "text")
    assert path.read_text() == "text"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_a_link_and_its_file_keeps_its_permissions(tmp_path):
    there, link = tmp_path / "there" / "report.json", tmp_path / "report.json"
    there.parent.mkdir()
    link.symlink_to(there)
    check_writable(link)
    write_whole(link, "first")  # the link leads nowhere yet
    there.chmod(0o600)
    write_whole(link, "second")
    assert link.is_symlink()
    assert (there.read_text(), there.stat().st_mode & 0o777) == ("second", 0o600)
    assert [entry.name for entry in there.parent.iterdir()] == ["report.json"]


def test_a_fifo_is_written_to(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    text = "x" * 300_000  # more than a pipe holds
    check_writable(pipe)
    with (tmp_path / "read").open("w") as out, subprocess.Popen(["cat", pipe], stdout=out):
        write_whole(pipe, text)
    assert (tmp_path / "read").read_text() == text
    assert pipe.is_fifo()


def test_a_fifo_that_nobody_reads_is_told_and_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "READER_SECONDS", 0.1)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(OutputError, match="nobody reads it"):
        write_whole(pipe, "text")
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    with pytest.raises(OutputError, match="its reader takes nothing any more"):
        write_whole(pipe, "x" * 300_000)
    os.close(reader)


def test_a_device_is_written_to_and_a_full_one_is_told():
    write_whole(Path("/dev/null"), "text")
    assert Path("/dev/null").is_char_device()
    with pytest.raises(OutputError, match="No space left"):
        write_whole(Path("/dev/full"), "text")
    assert Path("/dev/full").is_char_device()


@pytest.mark.parametrize("name", ["/dev/fd/{}", "/proc/self/fd/{}"])
def test_an_open_file_of_the_process_is_written_where_it_stands(tmp_path, name):
    with (tmp_path / "out").open("wb", buffering=0) as out:
        out.write(b"before, ")
        place = Path(name.format(out.fileno()))
        check_writable(place)
        write_whole(place, "report, ")
        out.write(b"after")
    assert (tmp_path / "out").read_text() == "before, report, after"
    with pytest.raises(OutputError, match="Bad file descriptor"):
        check_writable(Path("/dev/fd/987"))


def test_a_film_is_no_film_in_what_is_no_file(tmp_path):
    with pytest.raises(OutputError, match="is no regular file"):
        check_writable(Path("/dev/null"), regular=True)
    check_writable(tmp_path / "film.mp4", regular=True)


def test_folders_are_made_where_that_is_asked_for_or_refused_in_one_sentence(tmp_path):
    write_whole(tmp_path / "a" / "b" / "c.txt", "text", folders=True)
    assert (tmp_path / "a" / "b" / "c.txt").read_text() == "text"
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError) as refused:
        write_whole(tmp_path / "file" / "b" / "c.txt", "text", folders=True)
    assert str(refused.value).count("cannot be written") == 1
    assert str(refused.value).startswith(str(tmp_path / "file"))


def test_a_record_in_the_place_of_a_file_is_told_from_an_old_record(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OutputError, match="is a file; choose another folder"):
        prepare_folder(tmp_path / "file")
    assert (tmp_path / "file").read_text() == "mine"
    with pytest.raises(OutputError, match="cannot be written"):
        prepare_folder(tmp_path / "file" / "record")


def test_folders_of_a_record_are_made(tmp_path):
    prepare_folder(tmp_path / "a" / "b")
    assert [entry.name for entry in (tmp_path / "a" / "b").iterdir()] == ["run.mcap"]
