"""Figures and blame of rows that were made up."""

from __future__ import annotations

import json
import random
from typing import Any

from momantu_bt.bench.reports.report import report
from momantu_bt.bench.reports.table import columns
from momantu_bt.bench.reports.tables import row_text, summary_text
from momantu_bt.bench.statistics.blame import Blame, blame, general
from momantu_bt.bench.statistics.intervals import wilson
from momantu_bt.bench.statistics.summary import Summary


def link(code: str, node: str, line: int, cause: Any = None) -> dict[str, Any]:
    place = f"/home/me/trees/t.yaml:{line}"
    return {"code": code, "node": node, "place": place, "cause": cause, "beside": []}


def row(seed: int, **more: Any) -> dict[str, Any]:
    return {
        "key": f"k{seed}",
        "tree": "t.yaml",
        "seed": seed,
        "fault": None,
        "outcome": None,
        "made_of": {"python": "3"},
        "ended": "report",
        "exit_code": 0,
        "status": "SUCCESS",
        "success": True,
        "failure": None,
        "unmet": [],
        "error": None,
        "incidents": [],
        "sim_time_s": 80.0,
        "wall_time_s": 10.0,
        "process_time_s": 12.0,
        "memory_mb": 900.0,
        "tries": 0,
        "nodes": [{"name": "a", "runs": 1}],
        **more,
    }


def failed(seed: int, failure: Any, **more: Any) -> dict[str, Any]:
    return row(seed, status="FAILURE", success=False, failure=failure, **more)


def test_blame_is_of_the_innermost_failure_that_happened_by_itself() -> None:
    deep = link("LOST", "Put", 3, link("LOST", "recover", 4, link("TAG_NOT_SEEN", "find", 9)))
    assert blame(failed(1, deep)) == Blame("find", "t.yaml:9", "TAG_NOT_SEEN")
    timed = link("TIMEOUT", "pick", 5, link("HALTED", "reaching", 6))
    assert blame(failed(1, timed)) == Blame("pick", "t.yaml:5", "TIMEOUT")


def test_blame_of_what_has_no_failure() -> None:
    denied = row(1, success=False, unmet=["the can is 0.31 m from the tag", "it tilts by -4.0 deg"])
    words = "the can is # m from the tag; it tilts by # deg"
    assert blame(denied) == Blame("the referee", "", words)
    met = {"demand": "mug on desk", "place": "t.yaml:3", "met": True, "unmet": []}
    missed = {"demand": "can on desk", "place": "t.yaml:4", "met": False, "unmet": ["it fell"]}
    assert blame({**denied, "demands": [met, missed]}) == Blame("the referee", "t.yaml:4", words)
    assert blame(row(1, ended="hung", exit_code=-9)).node == "the process"
    broken = row(1, status="ERROR", error="Traceback …\nKeyError: 'x12'\n")
    assert blame(broken) == Blame("the engine", "", "KeyError: 'x#'")
    assert general("1.5 of 20 and -3e") == "# of # and #e"


def test_the_figures_add_up_whatever_the_rows() -> None:
    draw = random.Random(0)
    kinds = [
        lambda seed: row(seed, tries=draw.randrange(3), sim_time_s=draw.uniform(50, 150)),
        lambda seed: failed(seed, link(draw.choice("AB"), "n", draw.randrange(3))),
        lambda seed: row(seed, success=False, unmet=[f"{seed} m off"]),
        lambda seed: row(seed, success=None),
        lambda seed: row(seed, ended=draw.choice(["hung", "killed", "crashed"]), status=None),
    ]
    for _ in range(100):
        rows = [draw.choice(kinds)(seed) for seed in range(draw.randrange(30))]
        told = Summary.of(rows)
        good = [r for r in rows if r["status"] == "SUCCESS" and r["success"] is not False]
        good = [r for r in good if r["ended"] == "report"]
        assert (told.episodes, told.successes) == (len(rows), len(good))
        assert told.interval == wilson(len(good), len(rows))
        blamed = [seed for _, seeds in told.blame for seed in seeds]
        assert sorted(blamed) == sorted({r["seed"] for r in rows} - {r["seed"] for r in good})
        assert [len(seeds) for _, seeds in told.blame] == sorted(
            (len(seeds) for _, seeds in told.blame), reverse=True
        )
        assert sum(told.ended.values()) == len(rows)
        if good:
            times = sorted(r["sim_time_s"] for r in good)
            assert times[0] <= told.sim_time_s.median <= told.sim_time_s.p95 <= times[-1]
            assert told.sim_time_s.largest == times[-1]
        assert summary_text("t.yaml", told)
        json.loads(json.dumps(report(rows, {}), allow_nan=False))


def test_rows_of_faults_that_cannot_happen_do_not_count() -> None:
    impossible = row(7, fault="laser.dead", ended="impossible", output="there is no laser")
    told = Summary.of([row(1), impossible])
    assert (told.episodes, told.successes) == (1, 1)
    assert "there is no laser" in row_text(impossible)


def test_the_largest_force_is_told_with_its_seed() -> None:
    rows = [row(seed, measures={"force": 10.0 * seed}) for seed in (3, 9, 4)]
    told = Summary.of([*rows, row(5, measures={}), row(6, ended="hung", measures=None)])
    assert (told.force.largest, told.strongest) == (90.0, 9)
    assert "largest 90 N (seed 9)" in summary_text("t.yaml", told)
    assert told.as_dict()["force"]["seed"] == 9
    assert Summary.of([row(1)]).strongest is None


def test_the_bodies_of_the_largest_force_are_told() -> None:
    rows = [
        row(seed, measures={"force": 10.0 * seed}, causes={"force": f"elbow on wall_{seed}"})
        for seed in (3, 9, 4)
    ]
    told = Summary.of(rows)
    assert "largest 90 N (seed 9, elbow on wall_9)" in summary_text("t.yaml", told)
    assert told.as_dict()["force"]["bodies"] == "elbow on wall_9"


def test_incidents_are_counted_by_kind_with_their_seeds() -> None:
    push = {"time": 1.0, "kind": "force", "sentence": "…", "value": 160.0}
    drop = {"time": 2.0, "kind": "dropped", "sentence": "…", "value": 0.3}
    told = Summary.of([row(1, incidents=[push, push]), row(2, incidents=[drop]), row(3)])
    assert told.incidents == {"dropped": [2], "force": [1, 1]}
    assert "force: 2 in seed 1" in summary_text("t.yaml", told)


def test_a_report_has_a_row_per_episode_without_what_is_too_long() -> None:
    told = report([row(1), failed(2, link("A", "n", 3))], {"coverage": []})
    assert (told["episodes"], told["successes"], len(told["rows"])) == (2, 1, 2)
    assert told["made_of"] == {"python": "3"}
    assert told["coverage"] == []
    assert all("nodes" not in each and "made_of" not in each for each in told["rows"])
    assert told["blame"] == [{"node": "n", "place": "t.yaml:3", "code": "A", "seeds": [2]}]


def test_columns_stand_under_each_other() -> None:
    lines = columns([("share", "code"), ("9", "A"), ("100", "LONGER")], indent="")
    assert lines == ["share  code", "    9  A", "  100  LONGER"]


def test_claims_add_up_and_lies_keep_their_seeds() -> None:
    def pick(**counts: Any) -> dict[str, Any]:
        none = {"runs": 0, "successes": 0, "judged_successes": 0, "false_successes": 0, "lies": []}
        return {"claims": {"pick": {**none, **counts}}}

    lie = {"time": 3.0, "place": "t.yaml:9", "code": None, "claim": "Holding(something=True)"}
    alarm = {**lie, "code": "SLIPPED"}
    rows = [
        row(
            4, **pick(runs=2, successes=1, judged_successes=1, false_successes=1, lies=[lie, alarm])
        ),
        row(5, **pick(runs=1, successes=1, judged_successes=1)),
        row(6, claims=None),
    ]
    told = Summary.of(rows)
    assert told.claims["pick"].counts["runs"] == 3
    assert told.claims["pick"].counts["false_successes"] == 1
    assert [each["seed"] for each in told.as_dict()["claims"]["pick"]["lies"]] == [4, 4]
    (line,) = [line for line in summary_text("t", told).splitlines() if "pick" in line]
    assert line.split() == ["pick", "3", "2", "2", "1", "0", "0", "0", "seed", "4"]
