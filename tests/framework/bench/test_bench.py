"""`momantu-bt bench` from its arguments to its last line, with real processes."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from momantu_bt.bench.rows.store import RESULTS, Store, read_rows
from momantu_bt.cli import main

Out = pytest.CaptureFixture[str]


def bench(*words: object) -> int:
    return main(["bench", *map(str, words)])


def seeds_in(folder: Path) -> list[int]:
    return sorted(row["seed"] for row in read_rows(folder))


def test_it_counts_and_writes_and_goes_on(small: str, tmp_path: Path, capsys: Out) -> None:
    out, report = tmp_path / "out", tmp_path / "report.json"
    assert bench(small, "--seeds", "0:2", "--out", out, "--jobs", 2) == 0
    said = capsys.readouterr().out
    assert "2 of 2, 100.0 % (95 % interval 34.2 % to 100.0 %)" in said
    assert bench(small, "--seeds", "1:4", "--out", out, "--report", report) == 0
    said = capsys.readouterr().out
    assert "1 episodes are there already; 2 to run" in said
    assert "3 of 3" in said
    assert seeds_in(out) == [0, 1, 2, 3]
    told = json.loads(report.read_text())
    assert (told["episodes"], told["successes"], told["tries"]) == (3, 3, 3)
    assert told["interval"] == [pytest.approx(0.4385, abs=1e-4), 1.0]
    assert [row["seed"] for row in told["rows"]] == [1, 2, 3]
    assert {row["status"] for row in told["rows"]} == {"SUCCESS"}
    assert len({row["fingerprint"] for row in told["rows"]}) == 1
    assert all(row["memory_mb"] > 10 for row in told["rows"])


def test_a_process_that_goes_wrong_is_a_row_and_harms_no_other(
    stalling: str, tmp_path: Path, capsys: Out
) -> None:
    out = tmp_path / "out"
    assert bench(stalling, "--seeds", "0,2:6", "--out", out, "--record", "failures") == 0
    rows = {row["seed"]: row for row in read_rows(out)}
    ended = {seed: (row["ended"], row["exit_code"]) for seed, row in rows.items()}
    assert ended == {
        0: ("report", 0),
        2: ("crashed", 9),
        3: ("killed", -9),
        4: ("report", 0),
        5: ("report", 0),
    }
    said = capsys.readouterr().out
    assert "1 of 5" in said
    assert "STALLED" in said
    assert "stalling.yaml:7" in said
    assert "the can is # m away" in said
    assert "processes without a report: 1 crashed, 1 killed" in said
    records = {int(path.name.split("-")[1]) for path in (out / "records").iterdir()}
    assert records == {2, 3, 4, 5}


def test_what_skills_claim_is_judged_and_added_up(
    stalling: str, tmp_path: Path, capsys: Out
) -> None:
    """On seed 0 a success is denied, on seed 4 a failure is a false alarm, 5 and 7 are honest."""
    out, report = tmp_path / "out", tmp_path / "report.json"
    assert bench(stalling, "--seeds", "0,4:6,7", "--out", out, "--report", report) == 0
    rows = {row["seed"]: row["claims"]["stall"] for row in read_rows(out)}
    lies = {seed: [lie["code"] for lie in claims["lies"]] for seed, claims in rows.items()}
    assert lies == {0: [None], 4: ["STALLED"], 5: [], 7: []}
    counts = json.loads(report.read_text())["claims"]["stall"]
    told_lies = [(lie["seed"], lie["code"]) for lie in counts.pop("lies")]
    assert told_lies == [(0, None), (4, "STALLED")]
    assert counts == {
        "runs": 4,
        "successes": 3,
        "judged_successes": 3,
        "false_successes": 1,
        "failures": 1,
        "judged_failures": 1,
        "false_failures": 1,
    }
    told = capsys.readouterr().out
    (line,) = re.findall(r"^ +stall +(.*)$", told, re.MULTILINE)
    assert line.split() == ["4", "3", "3", "1", "1", "1", "1", "seed", "0"]


def test_faults_hit_a_strangers_tree_with_a_strangers_skill(
    turning: str, tmp_path: Path, capsys: Out
) -> None:
    """The skill declares its `uses` and failures alone; the tree's file adds a row."""
    own = "base.stuck@Again/turn_round:for=inf"
    Path(turning).with_suffix(".faults.yaml").write_text(
        f"momantu_bt: 1\nbegins: {{base.slow: Again/turn_round}}\nrows: ['{own}']\n"
    )
    out = tmp_path / "out"
    words = ("--faults", "base.stuck,base.slow,skill.exception,arm.slow")
    assert bench(turning, "--seeds", "7", *words, "--out", out) == 0
    rows = {row["fault"]: row for row in read_rows(out)}
    assert {fault: row["outcome"] for fault, row in rows.items()} == {
        "base.stuck": "safe",
        "base.stuck:for=inf": "safe",
        own: "safe",
        "base.slow": "recovered",
        "skill.exception": "safe",
        "arm.slow": "recovered",
    }
    assert rows["base.stuck"]["failure"]["code"] == "STUCK"
    begun = {fault: row["faults"][0]["fault"] for fault, row in rows.items()}
    assert begun["base.stuck"] == "base.stuck@turn_round"
    assert begun["base.slow"] == "base.slow@Again/turn_round"
    assert rows[own]["faults"][0]["began"] > rows["base.stuck"]["faults"][0]["began"]
    assert "turning.yaml, with faults" in capsys.readouterr().out


def test_faults_give_a_matrix(stalling: str, tmp_path: Path, capsys: Out) -> None:
    """A broken skill fails the tree with the true reason; this world has nothing to remove."""
    out, report = tmp_path / "out", tmp_path / "report.json"
    words = ("--fault", "skill.exception", "--faults", "process.*,object.removed")
    assert bench(stalling, "--seeds", "0,7", *words, "--out", out, "--report", report) == 0
    rows = {(row["fault"], row["seed"]): row["outcome"] for row in read_rows(out)}
    assert rows == {
        ("skill.exception", 0): "safe",
        ("skill.exception", 7): "safe",
        ("process.killed", 0): "safe",
        ("process.killed", 7): "safe",
        ("object.removed", 0): "impossible",
        ("object.removed", 7): "impossible",
    }
    told = json.loads(report.read_text())
    assert told["episodes"] == 4
    found = {line["fault"]: line for line in told["matrix"]["faults"]}
    assert found["skill.exception"]["safe"] == [0, 7]
    assert told["matrix"]["recoverable"]["episodes"] == 2
    said = capsys.readouterr().out
    assert "stalling.yaml, with faults: 0 of 4" in said
    assert "cannot happen: the world scripted cannot make object.removed" in said
    assert bench(stalling, "--seeds", "0,7", *words, "--out", out) == 0
    assert "0 to run" in capsys.readouterr().out


def test_a_fault_that_the_tree_cannot_have_is_refused(
    stalling: str, small: str, tmp_path: Path, capsys: Out
) -> None:
    words = ("--out", tmp_path / "out", "--fault")
    assert bench(stalling, *words, "skill.exception@pick") == 2
    assert "no node that runs is called 'pick'" in capsys.readouterr().err
    assert bench(small, *words, "camera.dead") == 2
    assert "this run has no world" in capsys.readouterr().err
    assert bench(small, *words, "camera.ded") == 2
    assert "did you mean dead?" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_hang_in_native_code_is_ended_from_outside(
    stalling: str, tmp_path: Path, capsys: Out
) -> None:
    words = (stalling, "--seeds", "1", "--out", tmp_path / "out", "--episode-limit", 3)
    assert bench(*words) == 0
    (row,) = read_rows(tmp_path / "out")
    assert (row["ended"], row["exit_code"]) == ("hung", -signal.SIGKILL)
    assert "hung, exit code -9" in capsys.readouterr().out
    assert not _processes_of(tmp_path)


def _processes_of(folder: Path) -> list[str]:
    """Command lines of processes of this machine that came from benches of the folder.

    Also of one that has begun to be an episode, and has its bench's name and open files still.
    """
    found = []
    for each in Path("/proc").glob("[0-9]*/environ"):
        try:
            if str(folder) in each.read_bytes().decode(errors="replace"):
                found.append((each.parent / "cmdline").read_text())
        except OSError:
            continue
    return found


def _left_after_a_while(folder: Path) -> list[str]:
    """Processes of the folder's benches that stay; empty once none was seen for a second.

    One look is not enough: a process shows no environment at the moment when it becomes an episode.
    """
    clear = 0
    for _ in range(300):
        found = _processes_of(folder)
        clear = 0 if found else clear + 1
        if clear == 10:
            break
        time.sleep(0.1)
    return found


def test_an_episode_that_cannot_begin_is_missing_and_says_why(
    stalling: str, tmp_path: Path, capsys: Out
) -> None:
    assert bench(stalling, "--seeds", "5:8", "--out", tmp_path / "out") == 1
    said = capsys.readouterr()
    assert "missing: seeds 6;" in said.err
    assert "there is no world for seed 6" in said.err
    assert seeds_in(tmp_path / "out") == [5, 7]


def test_rows_of_another_tree_are_left_out_and_named(
    small: str, tmp_path: Path, capsys: Out
) -> None:
    out, report = tmp_path / "out", tmp_path / "report.json"
    assert bench(small, "--seeds", "0:2", "--out", out) == 0
    assert bench(small, "--seeds", "0:1", "--out", out, "--set", "n=0") == 0
    assert "2 rows are left out: the values changed since" in capsys.readouterr().err
    Path(small).write_text(Path(small).read_text().replace("attempts: 2", "attempts: 3"))
    assert bench(small, "--seeds", "0:1", "--out", out, "--report", report) == 0
    said = capsys.readouterr().err
    assert "2 rows are left out: the file small.yaml changed since" in said
    assert "1 row is left out: the file small.yaml and the values changed since" in said
    assert json.loads(report.read_text())["episodes"] == 1
    assert len(read_rows(out)) == 4


def test_shards_share_the_episodes_and_every_one_is_run_once(small: str, tmp_path: Path) -> None:
    for number in (1, 2, 3):
        words = ("--seeds", "0:7", "--shard", f"{number}/3", "--out", tmp_path / str(number))
        assert bench(small, *words) == 0
    found = [seeds_in(tmp_path / str(number)) for number in (1, 2, 3)]
    assert found == [[0, 3, 6], [1, 4], [2, 5]]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--seeds", "5:5"], "empty; write 0:500"),
        (["--seeds", "all"], "is neither a seed nor a range"),
        (["--world", "moon"], "no world is called 'moon'"),
        (["--shard", "3/2"], "expected I/N"),
        (["--engine", "steam"], "valid values: local"),
        (["--record", "fail"], "did you mean failures?"),
        (["--out", "{tree}"], "cannot be written"),
        (["--report", "/nowhere/r.json"], "there is no folder"),
        (["--set", "m=3"], "the tree has no value 'm'"),
        (["--jobs", "0"], "--jobs"),
    ],
)
def test_wrong_arguments_are_a_sentence_and_nothing_starts(
    small: str, tmp_path: Path, capsys: Out, words: list[str], said: str
) -> None:
    filled = [word.format(tree=small) for word in words]
    out = [] if "--out" in words else ["--out", tmp_path / "out"]
    assert bench(small, *out, *filled) == 2
    told = capsys.readouterr()
    assert said in told.err
    assert "Traceback" not in told.err
    assert told.out == ""
    assert not (tmp_path / "out" / RESULTS).exists()


def test_a_tree_with_errors_is_told_as_check_does(tmp_path: Path, capsys: Out) -> None:
    file = tmp_path / "bad.yaml"
    file.write_text("momantu_bt: 1\nmain: Main\ntrees: {Main: [{wiat: 1 s}]}\n")
    assert bench(file, "--out", tmp_path / "out") == 2
    assert f"{file}:3" in capsys.readouterr().err


def test_a_folder_in_use_is_refused(small: str, tmp_path: Path, capsys: Out) -> None:
    with Store(tmp_path / "out"):
        assert bench(small, "--out", tmp_path / "out") == 2
    assert "another bench is writing" in capsys.readouterr().err


def test_a_demand_that_is_not_met_is_exit_code_1(small: str, tmp_path: Path, capsys: Out) -> None:
    words = (small, "--seeds", "0:2", "--out", tmp_path / "out", "--demand")
    assert bench(*words, 0.3) == 0
    assert bench(*words, 0.5) == 1
    assert "34.2 % is below 50 %" in capsys.readouterr().err


def _started(small: str, out: Path, **more: Any) -> subprocess.Popen[str]:
    words = [
        "-m",
        "momantu_bt",
        "bench",
        small,
        "--seeds",
        "0:40",
        "--out",
        str(out),
        "--jobs",
        "2",
    ]
    return subprocess.Popen(
        [sys.executable, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        **more,
    )


def test_without_a_referee_the_tree_has_the_last_word(
    stalling: str, tmp_path: Path, capsys: Out
) -> None:
    words = (stalling, "--seeds", "5", "--out", tmp_path / "out")
    assert bench(*words) == 0
    said = capsys.readouterr().out
    assert "0 of 1" in said
    assert "--no-referee counts what the tree says" in said
    assert bench(*words, "--no-referee") == 0
    said = capsys.readouterr()
    assert "1 of 1" in said.out
    assert "the referee" in said.err
    judged, told = read_rows(tmp_path / "out")
    assert (judged["success"], told["success"]) == (False, None)


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_a_bench_that_is_ended_goes_on_without_loss_or_double(
    small: str, tmp_path: Path, capsys: Out, monkeypatch: pytest.MonkeyPatch, end: signal.Signals
) -> None:
    monkeypatch.setenv("OF_THIS_TEST", str(tmp_path))
    out = tmp_path / "out"
    running = _started(small, out)
    assert running.stdout is not None
    for line in running.stdout:
        if line.startswith("[3/40]"):
            break
    running.send_signal(end)
    said = running.communicate(timeout=60)[0]
    had = seeds_in(out)
    assert 3 <= len(had) < 40
    if end is signal.SIGINT:
        assert running.returncode == 130, said
        assert "missing: seeds" in said
        assert "the same command goes on there" in said
    assert _left_after_a_while(tmp_path) == []
    last = max(had) + 2
    assert bench(small, "--seeds", f"0:{last}", "--out", out, "--jobs", 2) == 0
    assert f"{len(had)} episodes are there already" in capsys.readouterr().out
    assert seeds_in(out) == list(range(last))
