"""Findings as a person and a program read them."""

import json

from momantu_bt.findings import Finding, findings_json, findings_text, worst_first
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Severity

LATE = Finding("overlap", "a overlaps b by 2 cm", Place("w.yaml", 9, 3), "move it", seeds=(7,))
EARLY = Finding("door-narrow", "too narrow", Place("w.yaml", 2, 1), "widen it", seeds=(1, 2, 3, 9))
MILD = Finding("odd", "odd", hint="look at it", severity=Severity.WARNING)


def test_errors_come_first_then_the_order_of_the_file() -> None:
    assert worst_first([MILD, LATE, EARLY]) == [EARLY, LATE, MILD]


def test_a_line_says_where_what_and_in_which_episodes_and_the_next_what_to_do() -> None:
    lines = findings_text("w.yaml", [MILD, LATE, EARLY]).splitlines()
    assert lines == [
        "w.yaml:2:1: error: too narrow (door-narrow) [seeds 1-3, 9]",
        "    widen it",
        "w.yaml:9:3: error: a overlaps b by 2 cm (overlap) [seed 7]",
        "    move it",
        "warning: odd (odd)",
        "    look at it",
        "w.yaml: 2 errors and 1 warning",
    ]


def test_nothing_wrong_is_said_too() -> None:
    assert findings_text("w.yaml", []) == "w.yaml: nothing is wrong"
    assert findings_json("w.yaml", [])["ok"] is True


def test_json_has_every_field() -> None:
    data = json.loads(json.dumps(findings_json("w.yaml", [MILD, LATE])))
    assert data["subject"] == "w.yaml"
    assert data["ok"] is False
    assert data["findings"][0] == {
        "severity": "error",
        "code": "overlap",
        "message": "a overlaps b by 2 cm",
        "cure": "move it",
        "file": "w.yaml",
        "line": 9,
        "column": 3,
        "seeds": [7],
    }
    assert data["findings"][1]["file"] is None
