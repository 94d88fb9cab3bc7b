"""`momantu-bt run`: exit codes, messages, files, and never a stack trace for bad input."""

from __future__ import annotations

import json

import pytest

from momantu_bt.cli import main
from momantu_bt.record.reader import read_record
from momantu_bt.tree.files.settings import setting

TREE = """
momantu_bt: 1
main: Main
values: {n: 1, pause: 100 ms}
trees:
  Main:
    - wait: $pause
    - recover:
        attempts: 2
        try:
          - Check: {k: $n}
        catch:
          TOO_SMALL:
            - script: $n += 1
  Check:
    inputs: {k: int}
    if: $k > 1
    then: succeed
    else: {fail: {code: TOO_SMALL, message: "k is ${k}"}}
"""


@pytest.fixture
def tree(tmp_path):
    file = tmp_path / "tree.yaml"
    file.write_text(TREE)
    return str(file)


def run(*words):
    return main(["run", *map(str, words)])


def test_a_run_tells_each_change_and_ends_with_one_line(tree, capsys):
    assert run(tree) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(" s ", 1)[1].strip() for line in lines[:-1]] == [
        "wait 0.1 s starts",
        "wait 0.1 s done",
        "Check k 1 fails: TOO_SMALL",
        'fail code TOO_SMALL, message "k is ${k}" fails: TOO_SMALL, k is 1',
        "recover: TOO_SMALL: script $n += 1",
        "recover: try 2 of 2",
        "Check k 2 done",
    ]
    assert lines[-1].startswith("tree succeeded after 0.2 s simulated")


def test_quiet_leaves_the_last_line(tree, capsys):
    assert run(tree, "--quiet", "--set", "n=0") == 1
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith("tree failed: TOO_SMALL, k is 1 <- Check (tree.yaml:11), 2 of 2 tries")


def test_set_wins_over_values_and_values_over_the_tree(tree, tmp_path, capsys):
    file = tmp_path / "values.yaml"
    file.write_text("{n: 5, pause: 1 s}")
    report = tmp_path / "report.json"
    assert run(tree, "--values", file, "--set", "n=7", "--report", report) == 0
    assert json.loads(report.read_text())["blackboard"] == {"n": 7, "pause": 1.0}
    assert f"report: {report}" in capsys.readouterr().out


def test_record_leaves_a_log_and_a_report(tree, tmp_path):
    assert run(tree, "--record", tmp_path / "record", "-q") == 0
    recording = read_record(tmp_path / "record")
    assert recording.ticks[1].changes[0].status == "RUNNING"
    assert json.loads((tmp_path / "record/report.json").read_text())["status"] == "SUCCESS"


def test_the_fingerprint_is_the_same_with_and_without_a_record(tree, tmp_path):
    prints = set()
    for name, more in (("a", ()), ("b", ("--record", tmp_path / "record")), ("c", ("-q",))):
        file = tmp_path / f"{name}.json"
        run(tree, "--report", file, *more)
        prints.add(json.loads(file.read_text())["fingerprint"])
    assert len(prints) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere.yaml"], "there is no file nowhere.yaml"),
        (["{tree}", "--world", "moon"], "no world is called 'moon'"),
        (["{tree}", "--robot", "r2d2"], "r2d2"),
        (["{tree}", "--report", "{folder}/none/r.json"], "there is no folder"),
        (["{tree}", "--report", "{folder}"], "is a folder"),
        (["{tree}", "--video", "{folder}/v.mp4"], "need a world"),
        (["{tree}", "--values", "{folder}/none.yaml"], "cannot be read"),
        (["{tree}", "--set", "n"], "expected key=value"),
        (["{tree}", "--set", "n=[1"], "--set n=[1"),
        (["{tree}", "--seed", "-1"], "--seed"),
        (["{tree}", "--max-time", "soon"], "--max-time"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence_and_nothing_starts(
    tree, tmp_path, capsys, words, said
):
    filled = [word.format(tree=tree, folder=tmp_path) for word in words]
    assert run(*filled) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert "Traceback" not in err
    assert out == ""


def test_a_record_is_not_written_over(tree, tmp_path, capsys):
    run(tree, "--record", tmp_path / "record", "-q")
    assert run(tree, "--record", tmp_path / "record", "-q") == 2
    assert "holds a record already" in capsys.readouterr().err


def test_a_tree_with_errors_is_not_started(tmp_path, capsys):
    file = tmp_path / "bad.yaml"
    file.write_text("momantu_bt: 1\nmain: Main\ntrees: {Main: [{wiat: 1 s}]}\n")
    assert run(file) == 2
    out, err = capsys.readouterr()
    assert "wait" in err
    assert f"{file}:3" in err
    assert out == ""


def test_a_run_that_takes_too_long_ends_with_timeout(tree, capsys):
    assert run(tree, "--set", "pause=1 min", "--max-time", 1, "-q") == 1
    assert "TIMEOUT" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("n=3", ("n", 3)),
        ("pause=66 mm", ("pause", "66 mm")),
        ("from = table_b", ("from", "table_b")),
        ("can={height: 1 m}", ("can", {"height": "1 m"})),
        ("empty=", ("empty", "")),
        ("text=a=b", ("text", "a=b")),
    ],
)
def test_settings_are_read_as_a_tree_file_would(text, expected):
    assert setting(text) == expected


@pytest.mark.parametrize("text", ["n", "=3", "a b=3", "n={"])
def test_settings_that_are_none(text):
    with pytest.raises(ValueError):  # noqa: PT011, the message is the command line's business
        setting(text)
