"""A person at a real terminal: a pseudo-terminal whose other end the test reads and types at."""

from __future__ import annotations

import json
import os
import pty
import select
import subprocess
import sys
import time

import pytest

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

    def wait_for(self, text):
        until = time.monotonic() + DEADLINE
        start = len(self.seen)
        while text not in self.seen[start:]:
            assert time.monotonic() < until, f"{text!r} did not come:\n{self.seen}"
            assert self._read(), f"{text!r} did not come before the end:\n{self.seen}"
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
    there.wait_for("'floor' is none of: table_a, table_b").type("table_b")
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
