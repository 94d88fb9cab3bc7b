"""What hangs is ended: Python by an exception in the step, native code with the process."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from momantu_bt.engine import watchdog
from momantu_bt.engine.watchdog import Hung, Watchdog, waited_for_a_core
from momantu_bt.running.launch import LaunchError
from momantu_bt.skill import Run, Skill


class Stubborn(Skill):
    """Swallows every Exception, and hangs when it is closed."""

    def run(self, robot) -> Run:
        while True:
            try:
                yield "working"
                self._hang()
            except Exception:
                continue
            finally:
                self._hang()

    def _hang(self):
        while True:
            pass


class Sleepy(Skill):
    """Sleeps for ever in its third step."""

    def run(self, robot) -> Run:
        yield "one"
        yield "two"
        time.sleep(1e6)


TREE = "trees:\n  Main: {{fallback: [{0}, {{wait: 1 s}}]}}\n"


@pytest.mark.parametrize("kind", [Stubborn, Sleepy])
def test_a_step_that_hangs_fails_with_hung_and_the_tree_goes_on(run_yaml, kind):
    report = run_yaml(TREE.format(kind.__name__.lower()), kind, patience=0.2)
    assert report.status == "SUCCESS"
    assert [node.failures for node in report.nodes] == [0, 1, 0]


def test_the_failure_says_where_it_was(run_yaml):
    tree = "trees:\n  Main: [sleepy]\n"
    report = run_yaml(tree, Sleepy, patience=0.2)
    assert report.failure.code == "HUNG"
    assert "Sleepy gave no step back" in report.failure.message
    assert "time.sleep(1e6)" in report.failure.data["traceback"]
    assert report.fingerprint == run_yaml(tree, Sleepy, patience=0.3).fingerprint


@pytest.mark.parametrize("patience", [0.0, -1.0, math.nan])
def test_there_is_no_run_without_patience(run_yaml, patience):
    with pytest.raises(LaunchError, match="expected more than 0, or inf"):
        run_yaml("trees:\n  Main: [sleepy]\n", Sleepy, patience=patience)


def test_closing_a_skill_may_hang_too(run_yaml):
    tree = "trees:\n  Main: {parallel: {success_count: 1, children: [stubborn, {wait: 0 s}]}}\n"
    assert run_yaml(tree, Stubborn, patience=0.2).status == "SUCCESS"


def test_signals_and_timers_are_given_back():
    seen = []
    before = signal.signal(signal.SIGALRM, lambda *_: seen.append("rang"))
    outer = signal.setitimer(signal.ITIMER_REAL, 0.0)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with Watchdog(60.0) as dog:
            dog.begin_step()
            dog.end_step()
            assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0
        left, _ = signal.getitimer(signal.ITIMER_REAL)
        assert 0.0 < left <= 0.3
        signal.pause()
        assert seen == ["rang"]
    finally:
        signal.signal(signal.SIGALRM, before)
        signal.setitimer(signal.ITIMER_REAL, *outer)


def test_nothing_rings_outside_of_a_step():
    with Watchdog(0.05) as dog, dog.paused():
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        signal.pause()
    with Watchdog(0.05) as dog, dog.paused():
        dog.begin_step()
        with pytest.raises(Hung):
            signal.pause()


def test_time_for_which_other_processes_had_the_cores_does_not_count(monkeypatch):
    told = iter([1.0])
    monkeypatch.setattr(watchdog, "waited_for_a_core", lambda: next(told, 1.45))
    with Watchdog(0.5) as dog:
        dog.begin_step()
        began = time.monotonic()
        signal.pause()
        with pytest.raises(Hung):
            signal.pause()
        assert 0.94 < time.monotonic() - began < 5.0


def test_waiting_for_a_core_grows_where_more_run_than_there_are_cores():
    before = waited_for_a_core()
    code = "import time; e = time.monotonic() + 1\nwhile time.monotonic() < e: pass"
    count = 2 * (os.cpu_count() or 1)
    others = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(count)]
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        pass
    for other in others:
        other.wait()
    assert 0.05 < waited_for_a_core() - before < 5.0


def test_without_an_end_of_patience_and_in_other_threads_it_does_nothing():
    before = signal.getsignal(signal.SIGALRM)

    def watched(patience):
        with Watchdog(patience) as dog:
            dog.begin_step()
            handlers.append(signal.getsignal(signal.SIGALRM))
            dog.beat()
            dog.end_step()

    handlers = []
    watched(math.inf)
    thread = threading.Thread(target=watched, args=(60.0,))
    thread.start()
    thread.join()
    assert handlers == [before, before]


NATIVE = """
import momantu_bt.running.api as api
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry

class Drive(Skill):
    "Does nothing for long."
    def run(self, robot) -> Run:
        for _ in range(1000):
            yield "driving"

api.run({tree!r}, world=ScriptedWorld(), registry=Registry(skills={{"drive": Drive}}),
        faults=["skill.hang_native@drive+1 s"], patience=0.5)
print("never")
"""


def test_a_hang_in_native_code_ends_the_process_and_says_where_it_was(tmp_path):
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\nmain: Main\ntrees:\n  Main: [drive]\n")
    code = NATIVE.format(tree=str(tree))
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120
    )
    assert ended.returncode == 1
    assert ended.stdout == ""
    assert "Timeout" in ended.stderr
    assert "modes.py" in ended.stderr
