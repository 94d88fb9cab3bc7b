"""What a person sees before the world is open, in the terminal and in the browser."""

from __future__ import annotations

import io
import json
import socket
import sys
import threading
import time
import urllib.request
from contextlib import closing
from dataclasses import replace

import pytest
from rich.console import Console

from momantu_bt.cli.run import screen as screens
from momantu_bt.cli.run.live import LiveTree
from momantu_bt.cli.run.waiting_page import WaitingPage
from momantu_bt.errors import InputError
from momantu_bt.running.launch import launch
from momantu_bt.running.options import RunOptions
from momantu_bt.running.prepare import prepare
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.files.given_text import TreeText
from momantu_bt.tree.registry import Registry
from momantu_bt.world import TreeLine, WorldError

TREE = "momantu_bt: 1\nmain: Main\ntrees: {Main: [work, {wait: 0.1 s}]}\n"


class Work(Skill):
    """Does nothing for a tick."""

    def run(self, robot) -> Run:
        """One tick."""
        yield "at work"


class SlowEntry:
    """A world that looks at the screen before it opens."""

    def __init__(self, look):
        self.world, self.look, self.name = ScriptedWorld(), look, "slow"
        self.default_robot = self.world.robot.description.name
        self.seen = None

    def site(self):
        return self.world.site

    def open(self, description, seed, *, referee=True):
        self.seen = self.look()
        return self.world


def free_port():
    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture
def start(monkeypatch):
    """Run TREE in a slow world. Returns what its screen showed before, and the report."""

    def started(look, view_port=None, quiet=False):
        entry = SlowEntry(look)
        robots = {entry.default_robot: lambda: entry.world.robot.description}
        registry = Registry(skills={"work": Work}, worlds={"slow": entry}, robots=robots)
        prepared = prepare(TreeText(TREE), RunOptions(world="slow"), registry)
        screen = screens.open_screen(prepared, None, view_port, quiet=quiet)
        try:
            prepared = replace(prepared, options=replace(prepared.options, stage=screen.stage))
            shown = [] if screen.display is None else [screen.display]
            report = launch(prepared, lambda run: shown, (sys.stdout, sys.stderr))
        finally:
            screen.close()
        assert report.status == "SUCCESS"
        return entry.seen, report

    return started


def test_a_line_comes_before_the_world_is_open(start, capsys):
    seen, _ = start(lambda: capsys.readouterr().out)
    assert seen.startswith("preparing: world slow, robot ")
    assert "work starts" in capsys.readouterr().out
    assert start(lambda: capsys.readouterr().out, quiet=True)[0] == ""


def test_the_tree_stands_before_the_world_is_open(start, monkeypatch):
    out = io.StringIO()
    console = Console(file=out, force_terminal=True, width=80, height=24, no_color=True)
    monkeypatch.setattr(screens.consoles, "Console", lambda file: console)
    seen, with_screen = start(out.getvalue)
    assert "wait 0.1 s" in seen
    assert "preparing: opening the world slow with the robot" in seen
    assert with_screen.fingerprint == start(lambda: "", quiet=True)[1].fingerprint


def test_the_page_tells_what_is_prepared_until_the_view_comes(start):
    port = free_port()
    url = f"http://127.0.0.1:{port}"

    def look():
        page = urllib.request.urlopen(url, timeout=10).read().decode()
        status = urllib.request.urlopen(f"{url}/preparing", timeout=10).read()
        return page, json.loads(status)

    (page, status), _ = start(look, view_port=port)
    assert "Main in slow" in page
    assert "wait 0.1 s" in page
    assert status["stage"].startswith("opening the world slow")
    with closing(socket.socket()) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind(("127.0.0.1", port))


def test_a_port_in_use_is_told_at_once():
    with closing(socket.socket()) as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        with pytest.raises(WorldError, match="choose another port"):
            WaitingPage(other.getsockname()[1], "title", "")
    with pytest.raises(WorldError, match="choose another port"):
        WaitingPage(99999, "title", "")


def test_what_a_tree_says_stays_text_on_the_page():
    page = WaitingPage(free_port(), "<script>", "a < b")
    try:
        text = urllib.request.urlopen(page.url, timeout=10).read().decode()
    finally:
        page.close()
        page.close()
    assert "<h1>&lt;script&gt;</h1>" in text
    assert "a &lt; b" in text


def test_a_view_needs_a_world():
    prepared = prepare(TreeText("trees: {Main: [{wait: 0.1 s}]}\nmomantu_bt: 1"), RunOptions())
    with pytest.raises(InputError, match="need a world"):
        screens.open_screen(prepared, None, free_port(), quiet=True)


class KeptView:
    """A view that a person closes after the run."""

    url = "http://127.0.0.1:1"

    def __init__(self):
        self.told, self.ended, self.closed, self.dismissed = [], None, 0, False

    def update(self):
        pass

    def tell(self, headline, lines):
        self.told.append((headline, lines))

    def end(self, text):
        self.ended = text
        threading.Timer(0.3, lambda: setattr(self, "dismissed", True)).start()

    def close(self):
        self.closed += 1


def test_the_view_stays_until_a_person_closes_it(monkeypatch, capsys):
    view, world = KeptView(), ScriptedWorld()
    monkeypatch.setattr(world, "open_view", lambda port: view)
    screen = screens.Screen(None, None)
    registry = Registry(skills={"work": Work})
    prepared = prepare(TreeText(TREE), RunOptions(world=world), registry)
    report = launch(prepared, lambda run: [screen.open_view(world, 1, run)])
    assert view.closed == 0
    assert not any("has not ended" in remark for remark in report.remarks)
    assert any(line.text.startswith("work") for _, lines in view.told for line in lines)
    begun = time.monotonic()
    screen.keep_view("Main succeeded")
    assert time.monotonic() - begun >= 0.2
    assert view.ended == "Main succeeded"
    assert "stays open at http://127.0.0.1:1" in capsys.readouterr().out
    screen.close()
    assert view.closed == 1


def test_closing_before_the_first_tick_leaves_no_picture():
    out = io.StringIO()
    live = LiveTree(Console(file=out, force_terminal=True), [TreeLine(0, "sequence", "IDLE")])
    live.close()
    assert out.getvalue().endswith("\x1b[?25h") or "\x1b[2K" in out.getvalue()
    assert "s simulated" not in out.getvalue()
