"""`replay` and `diff` as a person calls them: in a pipe, in a script, at a real terminal."""

from __future__ import annotations

import json
import os
import pty
import select
import struct
import subprocess
import sys
import termios
import time
from fcntl import ioctl

import pytest

from momantu_bt.cli import main
from momantu_bt.record.text.ending import ending_text
from momantu_bt.record.text.failure import failure_line
from momantu_bt.replay.run_text import report_of

TREE = """
momantu_bt: 1
main: Main
values: {n: 0}
trees:
  Main:
    - Wait: {for: 3}
    - recover:
        attempts: 2
        try: [{wait: 0.2 s}, {condition: $n > 0}]
        catch:
          any: [{script: "$n := $n + 1"}]
    - parallel: [{wait: 1 s}, {wait: 0.3 s, repeat: 9}]
      timeout: 0.7 s
  Wait:
    inputs: {for: int}
    sequence:
      - {wait: 0.1 s, repeat: $for}
"""
DEADLINE = 60.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A record, with the lines that its run printed in `run.txt`."""
    folder = tmp_path_factory.mktemp("replayed")
    (folder / "tree.yaml").write_text(TREE, encoding="utf-8")
    words = ["run", str(folder / "tree.yaml"), "--record", str(folder / "run")]
    done = subprocess.run(
        [sys.executable, "-m", "momantu_bt", *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stderr
    (folder / "run.txt").write_text(done.stdout)
    return folder


@pytest.fixture
def call(capsys):
    def start(*words):
        code = main([str(word) for word in words])
        return code, *capsys.readouterr()

    return start


def test_in_a_pipe_it_prints_what_the_run_printed(folder, call):
    code, out, err = call("replay", folder / "run")
    assert (code, err) == (0, "")
    *lines, end = (folder / "run.txt").read_text().splitlines()
    head, *told, last = out.splitlines()
    assert head.startswith("tree, seed 0; momantu-bt ")
    assert told == lines
    assert len(told) > 10
    assert end.startswith(last)


def test_instants_are_printed_by_time_node_and_failure(folder, call):
    code, out, _ = call("replay", folder / "run", "--at", "1.2")
    assert code == 0
    assert out.startswith("-- 1.20 s, tick 24\n")
    assert "    wait 0.3 s  (9 rounds), round 2 of 9  RUNNING\n" in out
    assert "  n = 1\n" in out
    _, out, _ = call("replay", folder / "run", "--failure", -1, "--json")
    data = json.loads(out)
    assert data["status"] == "FAILURE"
    assert {n["failure"]["code"] for n in data["nodes"] if n["status"] == "FAILURE"} == {"TIMEOUT"}
    _, out, _ = call("replay", folder / "run", "--node", "script")
    assert "* n = 1\n" in out
    assert "failed: FAILED, `n > 0` does not hold" in out
    _, out, _ = call("replay", folder / "run", "--at", "0.7", "--node", "wait", "--json")
    assert json.loads(out)["time"] == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--node", "wiat"], "did you mean wait?"),
        (["--node", "script", "--at", "1.4"], "script never changes from 1.4 s on"),
        (["--failure", "9"], "there is no failure 9; the record has 2; 1 is the first, -1 the"),
        (["--failure", "0"], "there is no failure 0"),
        (["--at", "nan"], "nan is not a time; write seconds"),
    ],
)
def test_what_is_not_in_the_record_is_an_error_with_what_is(folder, call, words, said):
    code, out, err = call("replay", folder / "run", *words)
    assert (code, out) == (2, "")
    assert said in err


@pytest.mark.parametrize("verb", ["replay", "diff"])
def test_what_is_no_record_is_said(folder, call, tmp_path, verb):
    second = [folder / "run"] if verb == "diff" else []
    code, _, err = call(verb, tmp_path, *second)
    assert code == 2
    assert "--record" in err
    (tmp_path / "run.mcap").write_bytes(b"no record")
    assert call(verb, tmp_path, *second)[0] == 2


def test_a_record_that_was_cut_off_is_shown_up_to_there(folder, call, tmp_path):
    whole = (folder / "run" / "run.mcap").read_bytes()
    (tmp_path / "run.mcap").write_bytes(whole[: len(whole) // 2])
    code, out, err = call("replay", tmp_path)
    assert code == 0
    assert "cut off" in err
    assert "the record ends here" in out
    assert call("replay", tmp_path, "--check")[0] == 0
    code, out, _ = call("diff", folder / "run", tmp_path)
    assert code == 1
    assert "left:  goes on" in out


def test_check_says_that_the_tree_does_the_same_or_where_it_does_not(folder, call, monkeypatch):
    code, out, _ = call("replay", folder / "run", "--check")
    assert (code, out) == (0, "the tree did the same in all 30 ticks\n")
    from momantu_bt.nodes.timing import Sleep

    monkeypatch.setattr(Sleep, "step", lambda self: self.fail("BROKEN", "as if it were changed"))
    code, out, _ = call("replay", folder / "run", "--check")
    assert code == 1
    assert "in tick 1, 0.05 s: another status of wait" in out
    assert "recorded: RUNNING\n  here:     FAILURE" in out


def test_diff_says_equal_or_what_differs(folder, call, tmp_path):
    for name in ("one", "same"):
        call("run", folder / "tree.yaml", "-q", "--record", tmp_path / name)
    assert call("diff", tmp_path / "one", tmp_path / "same") == (
        0,
        "the runs are equal: the same in every tick, and the same end\n",
        "",
    )
    call("run", folder / "tree.yaml", "-q", "--set", "n=1", "--record", tmp_path / "other")
    code, out, _ = call("diff", folder / "run", tmp_path / "other")
    assert code == 1
    assert "first difference: tick 0, 0.00 s: write of n\n  left:  0\n  right: 1\n" in out
    assert "  value n: 0 | 1\n" in out
    code, out, _ = call("diff", folder / "run", tmp_path / "other", "--json")
    assert (code, json.loads(out)["first"]["kind"]) == (1, "write")


def test_a_report_from_a_record_ends_in_the_same_words(folder):
    data = json.loads((folder / "run" / "report.json").read_text())
    assert ending_text(report_of(data)).startswith("tree failed: TIMEOUT, ")
    assert "wait" in failure_line(report_of(data).failure)


class Screen:
    """Runs `momantu-bt replay` on a terminal of its own. seen: what it has drawn so far."""

    def __init__(self, folder):
        self._main, other = pty.openpty()
        ioctl(other, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        self.before = termios.tcgetattr(other)
        self._other = other
        self._program = subprocess.Popen(
            [sys.executable, "-m", "momantu_bt", "replay", str(folder)],
            stdin=other,
            stdout=other,
            stderr=other,
            start_new_session=True,
            env={**os.environ, "TERM": "xterm", "COLUMNS": "100", "LINES": "24"},
        )
        self.seen = ""

    def wait_for(self, text):
        until = time.monotonic() + DEADLINE
        while text not in self.seen:
            assert time.monotonic() < until, f"{text!r} did not come:\n{self.seen}"
            if select.select([self._main], [], [], 1.0)[0]:
                self.seen += os.read(self._main, 65536).decode(errors="replace")
        self.seen = self.seen[self.seen.index(text) + len(text) :]
        return self

    def type(self, keys):
        os.write(self._main, keys.encode())
        return self

    def end(self):
        code = self._program.wait(DEADLINE)
        after = termios.tcgetattr(self._other)
        os.close(self._other)
        os.close(self._main)
        return code, after


def test_at_a_terminal_keys_step_through_it(folder):
    screen = Screen(folder / "run")
    screen.wait_for("0.00 s of 1.50 s  tick 0").wait_for("? for the keys")
    screen.type("\x1b[C").wait_for("0.05 s of 1.50 s  tick 1").wait_for("Wait for 3")
    screen.type("f").wait_for("failure 1 of 2: condition: FAILED")
    screen.type("t1.2\r").wait_for("tick 24").wait_for("wait 0.3 s  (9 rounds), round 2 of 9")
    screen.type("b").wait_for("n = 1")
    screen.type("?").wait_for("q      leave")
    screen.type("?g++ ").wait_for("playing 4 x").wait_for("1.50 s of 1.50 s")
    screen.type("q").wait_for("tree failed: TIMEOUT")
    code, after = screen.end()
    assert code == 0
    assert after == screen.before, "the terminal is left as it was"
