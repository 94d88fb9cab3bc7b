"""An installed package whose skill breaks in many ways; its world's referee sees the robot."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

BREAKERS = '''
import builtins, os, signal, subprocess, sys, threading, time
from pathlib import Path

from momantu_bt.messages import BaseVelocity
from momantu_bt.robots.plugins import load_robot
from momantu_bt.skill import In, Run, Skill
from momantu_bt.testing import ScriptedWorld, scripted_site, small_robot
from momantu_bt.world import Verdict


class Odd(BaseException):
    pass


class Mute(Exception):
    def __str__(self):
        raise ValueError("no words")


def raising(error):
    def act():
        raise error
    return act


def deep():
    deep()


def beep():
    raise KeyboardInterrupt


WAYS = {
    "sys.exit(0)": lambda: sys.exit(0),
    "os._exit(0)": lambda: os._exit(0),
    "SystemExit": raising(SystemExit("enough")),
    "GeneratorExit": raising(GeneratorExit()),
    "StopIteration": raising(StopIteration(3)),
    "KeyboardInterrupt": beep,
    "BaseException": raising(Odd("odd")),
    "no text": raising(Mute()),
    "recursion": deep,
    "MemoryError": raising(MemoryError()),
    "kill -9": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "SIGTERM": lambda: os.kill(os.getpid(), signal.SIGTERM),
    "SIGHUP": lambda: os.kill(os.getpid(), signal.SIGHUP),
    "SIGINT": lambda: os.kill(os.getpid(), signal.SIGINT),
    "closes stdout": lambda: (os.close(1), os.close(2)),
    "chdir": lambda: os.chdir("/"),
    "takes SIGINT": lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    "low recursion limit": lambda: sys.setrecursionlimit(80),
    "redirects": lambda: setattr(sys, "stdout", open(os.devnull, "w")),
    "closes sys.stdout": lambda: sys.stdout.close(),
    "no print": lambda: setattr(builtins, "print", None),
    "thread": lambda: threading.Thread(target=time.sleep, args=(600,), name="sleeper").start(),
    "child": lambda: subprocess.Popen(["sleep", "600"], stdin=subprocess.DEVNULL,
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL),
    "prints": lambda: print("hello from a skill"),
    "nothing": lambda: None,
}


class BreakDown(Skill):
    """Drives, and breaks in its fourth tick."""

    how: str = In(doc="a way to break")
    uses = {"base"}

    def run(self, robot) -> Run:
        for tick in range(1, 8):
            robot.command("base", BaseVelocity(0.5, 0.0))
            if tick == 4:
                WAYS[self.how]()
            yield "driving"


class FullDisk:
    frames = 0

    def add(self, lines, headline):
        self.frames += 1
        if self.frames > 2:
            raise OSError(28, "No space left on device")

    def close(self):
        raise OSError(28, "No space left on device")


class Yard:
    """A world whose referee tells how fast the robot is in the end."""

    name, default_robot = "yard", "small"

    def site(self):
        return scripted_site()

    def open(self, description, seed, *, referee=True):
        def verdict(robot):
            last = [goal for _, name, goal in robot.commands if name == "base"][-1:]
            stopped = robot.linear == 0.0 and last in ([], [None])
            return Verdict(True, (), {"stopped": float(stopped), "way": robot.base.x})
        world = ScriptedWorld(verdict_of=verdict)
        if "BREAK_FILM" in os.environ:
            world.open_video = lambda path, title: FullDisk()
        return world


YARD = Yard()
'''
ENTRIES = """
[momantu_bt.skills]
break_down = breakers:BreakDown
[momantu_bt.worlds]
yard = breakers:YARD
[momantu_bt.robots]
small = breakers:small_robot
"""
TREE = """
momantu_bt: 1
world: yard
trees:
  Main:
    inputs: {{}}
    sequence:
      - break_down: {{how: "{how}"}}
      - break_down: {{how: nothing}}
"""
DEADLINE = 60.0
"""Seconds after which a program is given up."""


@dataclass(frozen=True)
class Ended:
    """How a command line ended. report: None where there is no report."""

    code: int
    out: str
    err: str
    report: dict[str, Any] | None


@dataclass(frozen=True)
class Installed:
    """A folder with an installed package, which `momantu-bt` finds."""

    folder: Path

    def environment(self) -> dict[str, str]:
        """The variables of a process that finds it."""
        return {**os.environ, "PYTHONPATH": str(self.folder)}

    def command(self, line: str) -> subprocess.CompletedProcess[str]:
        """Run `momantu-bt LINE` in the folder."""
        return subprocess.run(
            [sys.executable, "-m", "momantu_bt", *line.split()],
            cwd=self.folder,
            env=self.environment(),
            capture_output=True,
            text=True,
            timeout=DEADLINE,
        )

    def tree(self, folder: Path, how: str) -> Path:
        """A tree that breaks in a way."""
        file = folder / "tree.yaml"
        file.write_text(TREE.format(how=how))
        return file

    def run(self, folder: Path, how: str, *words: str, shell: str = "", **more: str) -> Ended:
        """Run a tree that breaks. shell: what follows the command line in a shell.

        more: variables of the environment.
        """
        report = folder / "report.json"
        command = [sys.executable, "-m", "momantu_bt", "run", self.tree(folder, how)]
        line = " ".join(map(str, [*command, "--report", report.name, *words, shell]))
        done = subprocess.run(
            ["bash", "-c", line],
            cwd=folder,
            env={**self.environment(), **more},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=DEADLINE,
        )
        read = json.loads(report.read_text()) if report.exists() else None
        return Ended(done.returncode, done.stdout, done.stderr, read)


def _install(folder: Path, name: str, entries: str, files: dict[str, str]) -> Installed:
    """Install a package of single modules into a folder. entries: its entry points."""
    about = folder / f"{name}-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(entries)
    for file, text in files.items():
        (folder / file).write_text(text)
    return Installed(folder)


@pytest.fixture(scope="session")
def install() -> Callable[..., Installed]:
    """Installs a package; see `_install`."""
    return _install


@pytest.fixture(scope="session")
def breakers(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """The package of skills that break."""
    folder = tmp_path_factory.mktemp("breakers")
    return _install(folder, "breakers", ENTRIES, {"breakers.py": BREAKERS})
