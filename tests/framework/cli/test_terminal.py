"""A person at a real terminal: a pseudo-terminal whose other end the test reads and types at."""

from __future__ import annotations

import json
import os
import pty
import select
import signal
import subprocess
import sys
import time

import pytest

from momantu_bt.cli import main

QUESTIONS = """
momantu_bt: 1
trees:
  Main:
    - wait: 0.1
    - ask: {question: "Which table?", choices: [table_a, table_b], answer: $table}
    - confirm: {question: "Really?", default: true}
    - wait: 0.1
"""
DEADLINE = 60.0
"""Seconds after which a silent program is given up, never waited for."""


class Typist:
    """Runs `momantu-bt` on a terminal of its own. seen: what it has shown so far."""

    def __init__(self, words):
        self._main, other = pty.openpty()
        command = [sys.executable, "-m", "momantu_bt", *map(str, words)]
        self._program = subprocess.Popen(
            command, stdin=other, stdout=other, stderr=other, start_new_session=True
        )
        os.close(other)
        self.seen = ""
        self._told = 0

    def wait_for(self, text):
        until = time.monotonic() + DEADLINE
        while text not in self.seen[self._told :]:
            assert time.monotonic() < until, f"{text!r} did not come:\n{self.seen}"
            assert self._read(), f"{text!r} did not come before the end:\n{self.seen}"
        self._told = self.seen.index(text, self._told) + len(text)
        return self

    def type(self, line):
        os.write(self._main, line.encode() + b"\n")
        return self

    def press(self, signal_number):
        self._program.send_signal(signal_number)
        return self

    def end(self):
        while self._read():
            pass
        os.close(self._main)
        return self._program.wait(DEADLINE)

    def _read(self):
        """Whether there was more to read before the program's end."""
        if not select.select([self._main], [], [], DEADLINE)[0]:
            return False
        try:
            data = os.read(self._main, 65536)
        except OSError:
            return False
        self.seen += data.decode(errors="replace")
        return bool(data)


@pytest.fixture
def typist(tmp_path):
    def start(text, *words):
        file = tmp_path / "tree.yaml"
        file.write_text(text)
        return Typist(["run", file, "--world", "none", *words])

    return start


@pytest.mark.parametrize("quiet", [(), ("-q",)])
def test_a_person_answers_and_is_asked_again(typist, tmp_path, quiet):
    report = tmp_path / "report.json"
    there = typist(QUESTIONS, "--report", report, *quiet)
    there.wait_for("? Which table?  (table_a, table_b): ").type("floor")
    there.wait_for("'floor' is not one of: table_a, table_b").type("table_b")
    there.wait_for("? Really?  (yes, no; Enter for yes): ").type("")
    assert there.end() == 0
    assert "tree succeeded after 0.2 s simulated" in there.seen.replace("\r\n", " ")
    assert json.loads(report.read_text())["blackboard"] == {"table": "table_b"}


def test_a_question_stands_alone_below_the_live_tree(typist):
    there = typist(QUESTIONS).wait_for("? Which table?")
    before, _, after = there.seen.rpartition("? Which table?")
    assert "s simulated" in before
    assert before.removesuffix("\x1b[?25h").endswith("\n")
    assert "\x1b[1A" not in after, "the live tree was drawn over the question"
    there.type("table_a").wait_for("Really?").type("no")
    assert there.end() == 1
    assert "DECLINED" in there.seen


@pytest.mark.parametrize("number", [2, 15])
def test_an_interrupt_in_a_question_ends_the_run(typist, tmp_path, number):
    report = tmp_path / "report.json"
    there = typist(QUESTIONS, "--report", report).wait_for("? Which table?").press(number)
    assert there.end() == 130
    ended = json.loads(report.read_text())
    assert (ended["status"], ended["blackboard"]) == ("INTERRUPTED", {})


def test_the_end_of_the_input_is_no_answer(typist):
    there = typist(QUESTIONS).wait_for("? Which table?").type("\x04")
    assert there.end() == 1
    assert "NO_ANSWER, nobody answers 'Which table?'" in there.seen.replace("\r\n", " ")


def test_unattended_nobody_is_asked(typist):
    there = typist(QUESTIONS, "--unattended")
    assert there.end() == 1
    assert "? Which" not in there.seen
    assert "NO_ANSWER" in there.seen


STOPS = """
momantu_bt: 1
main: Main
values: {n: 3}
trees:
  Main:
    - wait: 0.1
    - Sub: {k: $n}
    - set: {key: $m, value: $n}
    - succeed
  Sub:
    inputs: {k: int}
    retry:
      attempts: 2
      child:
        - script: $l := $k + 1
        - wait: 50 ms
          name: pause
"""


def test_a_breakpoint_shows_where_the_run_is_and_goes_on(typist):
    there = typist(STOPS, "--break", "pause", "-q")
    there.wait_for("before pause (").wait_for("break> ")
    assert "in sequence > Sub > retry > sequence" in there.seen
    assert "duration: 50 ms = 0.05" in there.seen
    there.type("keys").wait_for("k = 3").wait_for("l = 4").wait_for("break> ")
    there.type("print $l").wait_for("l = 4").wait_for("break> ")
    there.type("p @nn").wait_for("no key '@nn'; did you mean @n?").wait_for("break> ")
    there.type("tree").wait_for("IDLE").wait_for("break> ")
    there.type("what").wait_for("print KEY").wait_for("break> ")
    there.type("continue")
    assert there.end() == 0


def test_step_stops_before_each_node_that_starts(typist):
    there = typist(STOPS, "--break", "Sub", "-q").wait_for("before Sub (")
    assert "k: $n = 3" in there.wait_for("break> ").seen
    for node in ("retry", "sequence", "script", "pause", "set", "succeed"):
        there.type("step").wait_for(f"before {node} (").wait_for("break> ")
    there.type("")
    assert there.end() == 0


@pytest.mark.parametrize("leave", ["quit", "\x04", signal.SIGINT, signal.SIGTERM])
def test_leaving_at_a_breakpoint_interrupts_the_run(typist, tmp_path, leave):
    report = tmp_path / "report.json"
    there = typist(STOPS, "--break", "9", "--report", report).wait_for("before set (")
    there.wait_for("break> ")
    if isinstance(leave, str):
        there.type(leave)
    else:
        there.press(leave)
    assert there.end() == 130
    ended = json.loads(report.read_text())
    assert (ended["status"], ended["blackboard"]) == ("INTERRUPTED", {"n": 3})
    assert [node["runs"] for node in ended["nodes"] if node["type"] == "SetBlackboard"] == [0]


@pytest.mark.parametrize(
    ("place", "hint"),
    [("puase", "did you mean pause?"), ("3", "one does in line 7"), ("z*z", "nodes: Sequence")],
)
def test_a_breakpoint_that_names_nothing_is_an_error(typist, place, hint):
    there = typist(STOPS, "--break", place)
    assert there.end() == 2
    assert hint in there.seen.replace("\r\n", " ")


def test_a_breakpoint_needs_a_terminal(tmp_path, capsys):
    file = tmp_path / "tree.yaml"
    file.write_text(STOPS)
    assert main(["run", str(file), "--break", "pause"]) == 2
    assert "--break needs a person at a terminal" in capsys.readouterr().err
