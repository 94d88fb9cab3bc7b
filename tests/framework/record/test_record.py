"""Fingerprints, reports, failure chains and files."""

from __future__ import annotations

import json
import math
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.encode import encode
from momantu_bt.engine.fingerprint import Fingerprint
from momantu_bt.engine.skills.actuators import Issued
from momantu_bt.failure import FailureValue
from momantu_bt.formats.files import OutputError, check_writable, write_whole
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity
from momantu_bt.record.folder import prepare_folder
from momantu_bt.record.report import Report
from momantu_bt.record.text.ending import ending_text
from momantu_bt.record.text.failure import failure_line
from momantu_bt.world import Incident

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


@given(left=VALUES, right=VALUES)
def test_different_values_have_different_bytes(left, right):
    assert (encode(left) == encode(right)) == (_same(left, right))


def _same(left, right):
    if type(left) is not type(right):
        return False
    if isinstance(left, float):
        return left == right and math.copysign(1, left) == math.copysign(1, right)
    if isinstance(left, list):
        return len(left) == len(right) and all(map(_same, left, right))
    if isinstance(left, dict):
        return left.keys() == right.keys() and all(_same(left[k], right[k]) for k in left)
    return left == right


@given(items=st.dictionaries(st.text(), st.integers(), min_size=2, max_size=5))
def test_the_order_of_a_mapping_does_not_count(items):
    backwards = dict(reversed(items.items()))
    assert encode(items) == encode(backwards)


def test_every_bit_of_a_float_counts():
    assert encode(0.1) != encode(math.nextafter(0.1, 1.0))
    assert encode(np.array([0.1])) != encode(np.array([math.nextafter(0.1, 1.0)]))
    assert encode(Pose2D(0.0, 0.0, 0.0)) != encode(Pose2D(0.0, 0.0, -0.0))


def test_places_and_tracebacks_do_not_count():
    here = FailureValue("A", "b", {"traceback": "x", "n": 1}, place="/here/t.yaml:3")
    there = FailureValue("A", "b", {"traceback": "y", "n": 1}, place="/there/t.yaml:3")
    assert encode(here) == encode(there)
    assert encode(here) != encode(FailureValue("A", "b", {"n": 2}))


def prints(*ticks):
    fingerprint = Fingerprint()
    for tick in ticks:
        fingerprint.add(None, *tick)
    return fingerprint.hexdigest()


def test_a_fingerprint_knows_commands_statuses_and_writes():
    drive = Issued("base", BaseVelocity(0.1, 0.0))
    faster = Issued("base", BaseVelocity(0.2, 0.0))
    stop = Issued("base", None)
    ticks = [
        ([drive], [(0, "RUNNING")], [("n", 1)]),
        ([faster], [(0, "RUNNING")], [("n", 1)]),
        ([stop], [(0, "RUNNING")], [("n", 1)]),
        ([drive], [(1, "RUNNING")], [("n", 1)]),
        ([drive], [(0, "RUNNING")], [("n", 2)]),
    ]
    assert len({prints(tick) for tick in ticks}) == len(ticks)
    assert prints(ticks[0], ticks[1]) != prints(ticks[1], ticks[0])
    assert prints(ticks[0], ticks[2]) == prints(ticks[0], ticks[2])


def report(**changes):
    values = {
        "tree": "trees/bring_object.yaml",
        "world": "four_rooms",
        "robot": "fetch",
        "seed": 0,
        "status": "SUCCESS",
        "success": True,
        "failure": None,
        "unmet": (),
        "measures": {"tilt": 0.01},
        "sim_time_s": 80.0,
        "wall_time_s": 10.0,
        "start_time_s": 2.0,
        "ticks": 1600,
        "blackboard": {"pose": Pose2D(1.0, 2.0, 3.0), "far": math.inf},
        "nodes": (),
        "fingerprint": "0" * 64,
    }
    return Report(**{**values, **changes})


@pytest.mark.parametrize(
    ("status", "success", "code"),
    [
        ("SUCCESS", True, 0),
        ("SUCCESS", None, 0),
        ("SUCCESS", False, 1),
        ("FAILURE", True, 1),
        ("FAILURE", None, 1),
        ("INTERRUPTED", False, 130),
        ("ERROR", None, 4),
    ],
)
def test_exit_codes(status, success, code):
    assert report(status=status, success=success).exit_code == code


def test_a_report_tells_what_was_dangerous():
    drop = Incident(12.5, "dropped", "can left the hand 0.31 m above floor", 0.31)
    assert report(incidents=(drop,)).as_dict()["incidents"] == [
        {
            "time": 12.5,
            "kind": "dropped",
            "sentence": "can left the hand 0.31 m above floor",
            "value": 0.31,
        }
    ]


def test_a_report_is_plain_json_whatever_is_on_the_board(tmp_path):
    report().write(tmp_path / "report.json")
    read = json.loads((tmp_path / "report.json").read_text(), parse_constant=pytest.fail)
    assert read["blackboard"] == {"pose": {"x": 1.0, "y": 2.0, "yaw": 3.0}, "far": "inf"}
    assert read["real_time_factor"] == 8.0
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.json"]


def test_the_ending_is_one_line_with_both_opinions():
    denied = ending_text(report(success=False, unmet=("the can fell",)))
    assert denied == (
        "bring_object succeeded after 80.0 s simulated, 8.0 x real time; "
        "the referee denies success: the can fell; --no-referee leaves it to the tree"
    )
    inner = FailureValue(
        "PATH_BLOCKED", "a chair", {}, "navigate", "x/bring_object.yaml:41", None, (), 3, 3
    )
    outer = FailureValue("PATH_BLOCKED", "a chair", {}, "Put", "x/bring_object.yaml:22", inner)
    failed = ending_text(report(status="FAILURE", success=False, failure=outer))
    assert failed.startswith(
        "bring_object failed: PATH_BLOCKED, a chair <- Put (bring_object.yaml:22) <- "
        "navigate (:41), 3 of 3 tries; after 80.0 s"
    )
    error = report(status="ERROR", error="Traceback\nOSError: gone\n", success=None)
    assert ending_text(error).endswith("OSError: gone")


def test_a_cause_of_another_code_says_its_own():
    cause = FailureValue("HALTED", "was running", {}, "navigate", "t.yaml:9")
    outer = FailureValue("TIMEOUT", "took longer", {}, "timeout", "t.yaml:8", cause)
    assert failure_line(outer) == (
        "TIMEOUT, took longer <- timeout (t.yaml:8) <- navigate (:9): HALTED, was running"
    )


def test_a_file_is_whole_or_not_there(tmp_path):
    write_whole(tmp_path / "a.txt", "one")
    write_whole(tmp_path / "a.txt", "two")
    assert (tmp_path / "a.txt").read_text() == "two"
    with pytest.raises(OutputError, match="cannot be written"):
        write_whole(tmp_path / "none" / "a.txt", "three")


def test_unwritable_places_are_found_before_anything_starts(tmp_path):
    with pytest.raises(OutputError, match="no folder"):
        check_writable(tmp_path / "none" / "r.json")
    with pytest.raises(OutputError, match="is a folder"):
        check_writable(tmp_path)
    check_writable(tmp_path / "r.json")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_folder_is_named(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="cannot be written"):
        check_writable(tmp_path / "r.json")


def test_a_record_is_never_written_over(tmp_path):
    prepare_folder(tmp_path / "record")
    with pytest.raises(OutputError, match="holds a record already"):
        prepare_folder(tmp_path / "record")
