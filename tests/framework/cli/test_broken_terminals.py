"""Broken terminals, pipes and disks: the run goes on to its end, and says what was lost."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time

import pytest

from momantu_bt.cli import main

SHELL = {
    "a full disk": (">/dev/full", "standard output cannot be written (No space left on device)"),
    "closed": (">&-", "standard output is closed"),
    "both closed": (">&- 2>&-", "standard output is closed"),
    "errors to a full disk": ("2>/dev/full", ""),
}


@pytest.mark.parametrize("how", SHELL)
def test_a_broken_output_changes_neither_the_run_nor_its_exit_code(breakers, tmp_path, how):
    shell, words = SHELL[how]
    ended = breakers.run(tmp_path, "nothing", shell=shell)
    assert (ended.code, ended.report["status"]) == (0, "SUCCESS")
    assert ended.report["measures"] == {"stopped": 1.0, "way": pytest.approx(0.35)}
    assert any(words in said for said in ended.report["remarks"] or [""])
    assert ended.err.count("standard output") <= 1
    if "2>" not in shell:
        assert "tree succeeded" in ended.err


def test_a_reader_that_goes_away_leaves_the_exit_code_of_the_run(breakers, tmp_path):
    shell = "| head -1; exit ${PIPESTATUS[0]}"
    good = breakers.run(tmp_path, "nothing", shell=shell)
    assert (good.code, good.report["status"], good.out.count("\n")) == (0, "SUCCESS", 1)
    bad = breakers.run(tmp_path, "sys.exit(0)", shell=shell)
    assert (bad.code, bad.report["status"]) == (1, "FAILURE")


def test_a_bench_goes_on_without_its_progress(tmp_path):
    file = tmp_path / "tree.yaml"
    file.write_text("momantu_bt: 1\ntrees: {Main: [{wait: 0.1}]}")
    line = (
        f"{sys.executable} -m momantu_bt bench {file} --world none --seeds 0:2 --jobs 1 --out out"
    )
    done = subprocess.run(
        ["bash", "-c", f"{line} --report bench.json >/dev/full"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "standard output cannot be written" in done.stderr
    assert len(json.loads((tmp_path / "bench.json").read_text())["rows"]) == 2


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_characters_that_the_output_lacks_are_escaped(tmp_path, encoding):
    file = tmp_path / "tree.yaml"
    file.write_text("momantu_bt: 1\ntrees: {Main: [{wait: 0.1, name: 'größe 木'}]}")
    done = subprocess.run(
        [sys.executable, "-m", "momantu_bt", "run", file, "--world", "none"],
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
    )
    assert done.returncode == 0, done.stderr
    assert rb"\u6728: wait 0.1 starts" in done.stdout


def on_a_terminal(words, environment, then, width=80):
    """Run on a terminal of its own and call `then` with its descriptor; the exit code and text."""
    ours, theirs = pty.openpty()
    os.system(f"stty cols {width} rows 10 < /proc/self/fd/{theirs}")
    program = subprocess.Popen(
        [sys.executable, "-m", "momantu_bt", *map(str, words)],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env=environment,
        start_new_session=True,
        pass_fds=(theirs,),
    )
    os.close(theirs)
    text = then(ours, program)
    return program.wait(60.0), text


def read_all(ours, program):
    text = b""
    while True:
        try:
            more = os.read(ours, 65536)
        except OSError:
            break
        if not more:
            break
        text += more
    os.close(ours)
    return text.decode(errors="replace")


def test_a_terminal_that_vanishes_stops_neither_the_run_nor_the_report(breakers, tmp_path):
    tree = breakers.tree(tmp_path, "nothing")
    report = tmp_path / "report.json"

    def vanish(ours, program):
        os.read(ours, 100)
        os.close(ours)

    words = ["run", tree, "--report", report, "--realtime", "--unattended"]
    code, _ = on_a_terminal(words, breakers.environment(), vanish)
    told = json.loads(report.read_text())
    if told["status"] == "INTERRUPTED":
        assert (code, told["interrupted_by"]) == (130, "SIGHUP")
    else:
        assert (code, told["status"]) == (0, "SUCCESS")
        assert "standard output cannot be written" in told["remarks"][0]
    assert told["measures"]["stopped"] == 1.0


@pytest.mark.parametrize(("term", "width"), [("dumb", 80), ("xterm", 20), ("xterm", 1)])
def test_poor_terminals_show_the_run(breakers, tmp_path, term, width):
    words = ["run", breakers.tree(tmp_path, "nothing")]
    environment = {**breakers.environment(), "TERM": term, "NO_COLOR": "1"}
    code, text = on_a_terminal(words, environment, read_all, width)
    assert code == 0
    assert "tree succeeded" in text
    if term == "dumb":
        assert "\x1b" not in text
        assert "0.05 s break_down" in text


@pytest.mark.parametrize(("how", "code"), [("nothing", 4), ("sys.exit(0)", 1)])
def test_a_report_that_gets_lost_is_told_and_the_exit_code_is_not_0(breakers, tmp_path, how, code):
    ended = breakers.run(tmp_path, how, "--report /dev/full")
    assert ended.code == code
    assert "there is no report: /dev/full cannot be written: No space left" in ended.err
    assert "lost: /dev/full" in ended.out


def test_a_film_that_breaks_off_is_told_and_the_run_goes_on(breakers, tmp_path):
    ended = breakers.run(tmp_path, "nothing", "--video film.txt", BREAK_FILM="1")
    assert (ended.code, ended.report["status"]) == (4, "SUCCESS")
    assert ended.report["measures"]["way"] == pytest.approx(0.35)
    assert "the film film.txt breaks off here: No space left on device" in ended.err
    assert ended.report["lost"] == ["film.txt"]
    assert "lost: film.txt" in ended.out


@pytest.mark.parametrize(
    ("words", "code"), [("show {}", 4), ("check {}", 4), ("skills", 4), ("--help", 4)]
)
def test_a_verb_that_only_prints_tells_of_a_full_disk(breakers, tmp_path, words, code):
    line = words.format(breakers.tree(tmp_path, "nothing"))
    done = subprocess.run(
        ["bash", "-c", f"{sys.executable} -m momantu_bt {line} >/dev/full"],
        env=breakers.environment(),
        capture_output=True,
        text=True,
    )
    assert done.returncode == code
    assert done.stderr.splitlines() == [
        "momantu-bt: standard output cannot be written: No space left on device"
    ]


def test_a_report_path_is_that_of_the_start(breakers, tmp_path):
    ended = breakers.run(tmp_path, "chdir", "--record", "record")
    assert ended.code == 0
    assert (tmp_path / "record" / "report.json").exists()
    assert ended.report["lost"] == []


@pytest.mark.parametrize("option", ["--report", "--record", "--video"])
def test_a_folder_that_cannot_be_written_is_told_before_the_start(breakers, tmp_path, option):
    ended = breakers.run(tmp_path, "nothing", option, "/proc/nothing/x.json")
    assert (ended.code, ended.report) == (2, None)
    assert "/proc/nothing/x.json cannot be written" in ended.err
    assert "starts" not in ended.out


def test_an_old_report_does_not_stand_in_for_a_run_that_could_not_begin(tmp_path, capsys):
    report = tmp_path / "report.json"
    report.write_text("old")
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\ntrees: {Main: [{wait: 0.1}]}")
    assert main(["run", str(tree), "--report", str(report), "--video", str(tmp_path / "v")]) == 2
    assert report.read_text() == "old"
    assert main(["run", str(tree), "--report", str(report)]) == 0
    assert json.loads(report.read_text())["status"] == "SUCCESS"
    capsys.readouterr()


def test_a_second_signal_ends_the_coming_to_rest_and_the_report_is_there(breakers, tmp_path):
    report = tmp_path / "report.json"
    words = ["run", breakers.tree(tmp_path, "nothing"), "--report", report, "--realtime"]
    program = subprocess.Popen(
        [sys.executable, "-m", "momantu_bt", *map(str, words)],
        env=breakers.environment(),
        stdout=subprocess.PIPE,
        text=True,
    )
    for _ in range(2):  # what is prepared, and the first line of the run
        program.stdout.readline()
    for _ in range(4):
        program.send_signal(signal.SIGINT)
        time.sleep(0.01)
    program.stdout.read()
    assert program.wait(60.0) == 130
    assert json.loads(report.read_text())["status"] == "INTERRUPTED"
