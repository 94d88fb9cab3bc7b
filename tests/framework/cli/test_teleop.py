"""`momantu-bt teleop` at a pseudo-terminal: keys drive a scripted robot in a room with a map."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import termios
import time

import pytest

ROOM = """
from momantu_bt.testing import ExampleWorld, ScriptedRobot, small_robot
from momantu_bt.testing.example_world import _seeing


class Room:
    name, default_robot = "room", "small"

    def site(self):
        return ExampleWorld().site

    def open(self, description, seed, *, referee=True):
        return ExampleWorld(seed, ScriptedRobot(_seeing(description)))


class Burning(Room):
    name = "burning"

    def open(self, description, seed, *, referee=True):
        world = super().open(description, seed)
        step = world.step
        def burn():
            if world.now() > 0.5:
                raise RuntimeError("fire")
            step()
        world.step = burn
        return world


ROOM, BURNING = Room(), Burning()
"""
ENTRIES = """
[momantu_bt.worlds]
room = room:ROOM
burning = room:BURNING
[momantu_bt.robots]
small = room:small_robot
"""
DEADLINE = 60.0


@pytest.fixture(scope="module")
def room(install, tmp_path_factory):
    return install(tmp_path_factory.mktemp("room"), "room", ENTRIES, {"room.py": ROOM})


class Seat:
    """A person at a terminal of 80 columns and 24 lines. seen: all that was drawn."""

    def __init__(self, room, *words, world="room"):
        self.main, self.other = pty.openpty()
        fcntl.ioctl(self.other, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        self.before = termios.tcgetattr(self.other)
        command = [sys.executable, "-m", "momantu_bt", "teleop", "--world", world, *map(str, words)]
        self.program = subprocess.Popen(
            command,
            stdin=self.other,
            stdout=self.other,
            stderr=self.other,
            env={**room.environment(), "TERM": "xterm-256color"},
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        )
        self.seen = ""
        self._told = 0

    def wait_for(self, text):
        until = time.monotonic() + DEADLINE
        while text not in self.seen[self._told :]:
            assert time.monotonic() < until, f"{text!r} did not come:\n{self.seen[-3000:]}"
            assert self.program.poll() is None or self._read(1.0), self.seen
            self._read(0.1)
        self._told = self.seen.index(text, self._told) + len(text)
        return self

    def hold(self, key, text):
        """Press a key again and again, as a keyboard repeats it, until a text is shown."""
        until = time.monotonic() + DEADLINE
        while text not in self.seen[self._told :]:
            assert time.monotonic() < until, f"{text!r} did not come:\n{self.seen[-3000:]}"
            os.write(self.main, key.encode())
            self._read(0.03)
        return self.wait_for(text)

    def type(self, keys):
        os.write(self.main, keys.encode())
        return self

    def end(self):
        """The exit code; the terminal is as it was."""
        until = time.monotonic() + DEADLINE
        while self.program.poll() is None and time.monotonic() < until:
            self._read(0.1)
        while self._read(0.1):
            pass
        code = self.program.wait(1.0)
        after = termios.tcgetattr(self.other)
        os.close(self.main)
        os.close(self.other)
        assert after == self.before
        assert self.seen.count("\x1b[?1049h") == self.seen.count("\x1b[?1049l")
        return code

    def _read(self, seconds):
        if not select.select([self.main], [], [], seconds)[0]:
            return False
        self.seen += os.read(self.main, 65536).decode(errors="replace")
        return True


def cli(room, *words):
    return subprocess.run(
        [sys.executable, "-m", "momantu_bt", *map(str, words)],
        env=room.environment(),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
    )


def test_a_person_drives_and_the_record_is_that_of_a_run(room, tmp_path):
    folder, report = tmp_path / "record", tmp_path / "report.json"
    there = Seat(room, "--record", folder, "--report", report).wait_for("x leave")
    there.hold("w", "driving").type("m").hold("i", "moving a joint").hold("c", "closing")
    there.type("x")
    assert there.end() == 0
    told = json.loads(report.read_text())
    assert (told["status"], told["world"], told["robot"]) == ("SUCCESS", "scripted", "small")
    assert "teleop succeeded after" in there.seen
    assert "x real time" in there.seen
    assert told["sim_time_s"] < 1.2 * told["wall_time_s"] + 0.2, "no faster than real time"
    check = cli(room, "replay", folder, "--check")
    assert check.returncode == 0, check.stderr
    assert "the tree did the same" in check.stdout
    assert cli(room, "diff", folder, folder).returncode == 0


@pytest.mark.parametrize(
    ("leave", "code"),
    [
        ("\x04", 0),
        ("\x03", 130),
        (signal.SIGTERM, 130),
        (signal.SIGHUP, 130),
    ],
)
def test_however_it_ends_the_robot_stands_and_the_terminal_is_as_before(
    room, tmp_path, leave, code
):
    report = tmp_path / "report.json"
    there = Seat(room, "--report", report).wait_for("x leave").hold("w", "driving")
    if isinstance(leave, str):
        there.type(leave)
    else:
        there.program.send_signal(leave)
    assert there.end() == code
    told = json.loads(report.read_text())
    assert told["status"] == ("SUCCESS" if code == 0 else "INTERRUPTED")


def test_an_error_in_the_world_gives_the_terminal_back(room):
    there = Seat(room, world="burning")
    assert there.end() == 4
    assert "fire" in there.seen


def test_keys_pressed_before_the_start_do_not_count(room):
    there = Seat(room).type("wwwxxxx").wait_for("x leave")
    there.hold("z", "'z' has no meaning").type("\x1a").wait_for("'Ctrl-Z' has no").type("x")
    assert there.end() == 0


def test_without_a_terminal_it_refuses_in_a_sentence(room):
    ended = cli(room, "teleop")
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "standard input and output must both be a terminal" in ended.stderr
    assert len(ended.stderr.splitlines()) == 1


def test_a_terminal_that_is_closed_stops_the_robot(room, tmp_path):
    report = tmp_path / "report.json"
    there = Seat(room, "--report", report).wait_for("x leave").hold("w", "driving")
    os.close(there.other)
    os.close(there.main)
    assert there.program.wait(DEADLINE) == 130
    told = json.loads(report.read_text())
    assert (told["status"], told["interrupted_by"]) == ("INTERRUPTED", "SIGHUP")


@pytest.mark.parametrize(
    ("world", "said"),
    [("nope", "no world is called 'nope'"), ("none", "needs a world with a robot")],
)
def test_a_wrong_world_is_told_and_nothing_starts(room, world, said):
    there = Seat(room, world=world)
    assert there.end() == 2
    assert said in there.seen
    assert "\x1b[?1049h" not in there.seen
