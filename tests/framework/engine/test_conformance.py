"""Files run as BehaviorTree.CPP 4.10 runs them, to the tick, the way the command line runs them.

Each case holds a file in BehaviorTree.CPP's XML, and what the reference engine recorded, ticking
exactly once per tick: the final status, the number of ticks, and v0 to v5 on the root's board. The
cases of `conformance_meaning.jsonl` hold all keys of the root's board (`keys`): scripts, subtrees,
the root's keys, and the nodes that the others leave out.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import momantu_bt
from momantu_bt.record.report import Report

CASES = Path(__file__).parent / "conformance_cases.jsonl"
MEANING = Path(__file__).parent / "conformance_meaning.jsonl"


def cases(file=CASES):
    return [json.loads(line) for line in file.read_text().splitlines()]


def outcome(report):
    return report["status"], report["ticks"], [report["blackboard"][f"v{i}"] for i in range(6)]


def recorded(case):
    return case["status"], case["ticks"], case["v"]


@pytest.mark.parametrize("case", cases(), ids=lambda case: case["id"])
def test_a_recorded_tree_ends_as_the_reference_engine_did(case, tmp_path):
    file = tmp_path / "case.xml"
    file.write_text(case["xml"])
    report: Report = momantu_bt.run(file, world="none")
    assert outcome(report.as_dict()) == recorded(case)


@pytest.mark.parametrize("case", cases(MEANING), ids=lambda case: case["id"])
def test_a_recorded_tree_leaves_the_keys_that_the_reference_engine_left(case, tmp_path):
    file = tmp_path / "case.xml"
    file.write_text(case["xml"])
    report = momantu_bt.run(file, world="none").as_dict()
    assert report["status"] == case["status"].replace("SKIPPED", "SUCCESS")
    assert report["ticks"] == case["ticks"]
    assert report["blackboard"] == pytest.approx(case["keys"])


@pytest.mark.parametrize("case", cases()[::100], ids=lambda case: case["id"])
def test_a_recorded_tree_from_the_command_line(case, tmp_path):
    file, report = tmp_path / "case.xml", tmp_path / "report.json"
    file.write_text(case["xml"])
    words = ["run", str(file), "--world", "none", "--quiet", "--report", str(report)]
    ended = subprocess.run([sys.executable, "-m", "momantu_bt", *words], check=False)
    assert ended.returncode == (0 if case["status"] == "SUCCESS" else 1)
    assert outcome(json.loads(report.read_text())) == recorded(case)
