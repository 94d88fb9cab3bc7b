"""Benches of trees so small that an episode is little more than a start of Python.

The plug-ins stand in a folder of their own, so that the processes of episodes find them too.
"""

from __future__ import annotations

import os
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from momantu_bt import plugins
from momantu_bt.cli import main

SMALL = """
momantu_bt: 1
main: Main
world: none
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
STALLING = """
momantu_bt: 1
main: Main
world: by_seed
trees:
  Main:
    - stall:
        seeds: {hang: [1], crash: [2], kill: [3], fail: [4], kill_worker: [8, 9]}
goal: world
"""
PLUGINS = '''
"""A skill that goes wrong on some seeds, in a world that tells it the seed."""

import ctypes
import os
import signal
import time
from typing import Any

from momantu_bt import Failure, In, Pose2D, Robot, Run, Skill
from momantu_bt.claim import Holding
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, scripted_site, small_robot
from momantu_bt.world import Verdict, WorldError


class Stall(Skill):
    """Do what is said for the seed, which is where the robot stands."""

    seeds: Any = In(doc="numbers of seeds by what happens on them")
    failures = {"STALLED": "it was told to"}

    def run(self, robot: Robot) -> Run:
        yield "begin"
        seed = round(robot.state().odom_from_base.position[0])
        for how, on in self.seeds.items():
            if seed in on:
                kill_worker(seed) if how == "kill_worker" else globals()[how]()

    def claim(self, robot, failure):
        return Holding(True)


def hang():
    ctypes.PyDLL(None).sleep(1000)  # holds the interpreter's lock: no thread of Python runs


def crash():
    os._exit(9)


def kill():
    os.kill(os.getpid(), signal.SIGKILL)


def kill_worker(seed):
    """Kill the Ray worker that waits for this episode; on seed 9 the first one alone.

    The second time the process must be as if there was no Ray.
    """
    worker = os.getppid()
    with open(f"/proc/{worker}/cmdline") as file:
        if not file.read().startswith("ray::"):
            raise Failure("STALLED", "it is no Ray worker that waits")
    if seed == 9:
        try:
            os.close(os.open(os.environ["KILLED_ONCE"], os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            if blocked := signal.pthread_sigmask(signal.SIG_BLOCK, ()):
                raise Failure("STALLED", f"signals are blocked: {blocked}") from None
            if os.nice(0) != int(os.environ["NICENESS"]):
                raise Failure("STALLED", f"it gives way by {os.nice(0)}") from None
            return
    os.kill(worker, signal.SIGKILL)
    time.sleep(60)  # the kernel ends this process too


def fail():
    raise Failure("STALLED", "it was told to, 3 times")


class Judged(ScriptedWorld):
    """Something is held on seeds 4 and up."""

    def judge(self, sentence, odom_from_base):
        return sentence == Holding(odom_from_base.position[0] > 3.5)


class BySeed:
    """A world entry: seed 5 is denied by the referee, seed 6 cannot be opened."""

    name, default_robot = "by_seed", "small"

    def site(self):
        return scripted_site()

    def open(self, description, seed, *, referee=True):
        if seed == 6:
            raise WorldError("there is no world for seed 6")
        denied = Verdict(False, (f"the can is {seed}.25 m away",))
        robot = ScriptedRobot(description, base=Pose2D(float(seed), 0.0, 0.0))
        verdict = (denied if seed == 5 else Verdict(True)) if referee else None
        return Judged(robot, verdict_of=lambda _: verdict)


world = BySeed()
'''
ENTRIES = """
[momantu_bt.skills]
stall = stall_plugins:Stall
[momantu_bt.worlds]
by_seed = stall_plugins:world
[momantu_bt.robots]
small = stall_plugins:small_robot
"""


def _write(file: Path, text: str) -> str:
    file.write_text(text, encoding="utf-8")
    return str(file)


@pytest.fixture
def small(tmp_path: Path) -> str:
    """A tree without skills, that tries once again and succeeds."""
    return _write(tmp_path / "small.yaml", SMALL)


@pytest.fixture
def stalling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A tree that goes wrong in another way on each of seeds 1 to 6, 8 and 9."""
    monkeypatch.setenv("KILLED_ONCE", str(tmp_path / "killed_once"))
    monkeypatch.setenv("NICENESS", str(os.nice(0)))
    folder = tmp_path / "site"
    facts = folder / "stall_plugins-1.0.dist-info"
    facts.mkdir(parents=True)
    _write(folder / "stall_plugins.py", PLUGINS)
    _write(facts / "METADATA", "Metadata-Version: 2.1\nName: stall-plugins\nVersion: 1.0\n")
    _write(facts / "entry_points.txt", ENTRIES)
    path = os.environ.get("PYTHONPATH", "")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [str(folder), path])))
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "stall_plugins", raising=False)
    _look_again(monkeypatch)
    return _write(tmp_path / "stalling.yaml", STALLING)


READ_EVERYTHING = plugins._everything.__wrapped__
"""Reads the entry points anew at each call."""


def _look_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """What has just been installed is found, though entry points are read once a process."""
    find = plugins.entry_points
    monkeypatch.setattr(plugins, "_everything", READ_EVERYTHING)
    monkeypatch.setattr(plugins, "entry_points", lambda group: find(group))


TURNING = """
momantu_bt: 1
main: Main
world: by_seed
trees:
  Main: [Once, Again]
  Once: {turn_round: {angle: 0.5}}
  Again: {turn_round: {angle: -0.5}}
"""


@pytest.fixture
def turning(stalling: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A tree that turns to and fro with a skill of a package that `skills new` makes."""
    assert main(["skills", "new", "turn_round", "--into", str(tmp_path)]) == 0
    source = tmp_path / "turn_round" / "src"
    project = (tmp_path / "turn_round" / "pyproject.toml").read_text(encoding="utf-8")
    (entry,) = tomllib.loads(project)["project"]["entry-points"]["momantu_bt.skills"].items()
    facts = source / "turn_round-1.0.dist-info"
    facts.mkdir()
    _write(facts / "METADATA", "Metadata-Version: 2.1\nName: turn-round\nVersion: 1.0\n")
    _write(facts / "entry_points.txt", "[momantu_bt.skills]\n{} = {}\n".format(*entry))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(source), os.environ["PYTHONPATH"]]))
    monkeypatch.syspath_prepend(source)
    _look_again(monkeypatch)
    yield _write(tmp_path / "turning.yaml", TURNING)
    for module in [each for each in sys.modules if each.startswith("turn_round_skill")]:
        del sys.modules[module]
