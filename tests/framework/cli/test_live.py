"""The live tree and the plain lines: what a person sees, and that nothing seen is stale."""

from __future__ import annotations

import io
import itertools
import threading
import time

import pytest
from rich.console import Console

from momantu_bt.cli.run.live import LiveTree
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.running.api import run
from momantu_bt.skill import Failure, In, Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry
from momantu_bt.world import TreeLine

TREE = """
momantu_bt: 1
main: Main
trees:
  Main:
    - Take
    - work: {ticks: 2}
      timeout: 1 min
  Take:
    recover:
      attempts: 2
      try:
        - work: {ticks: 2, code: SLIPPED}
      catch:
        SLIPPED:
          round_robin:
            - work: {ticks: 3}
"""


class Work(Skill):
    """Works for some ticks; fails on its first start where a code is given."""

    ticks: int = In(1, doc="how many")
    code: str = In("", doc="what to fail with")
    failures = {"SLIPPED": "slipped"}
    started = 0

    def run(self, robot) -> Run:
        Work.started += 1
        first = Work.started == 1
        for _ in range(self.ticks):
            yield "working"
        if self.code and first:
            raise Failure(self.code, "it slipped")


class Watcher:
    """Keeps the lines of each tick."""

    def __init__(self):
        self.frames = []
        self.headlines = []

    def ticked(self, run):
        lines = [(line.depth, line.text, line.status) for line in tree_lines(run.built.root)]
        self.frames.append(lines)
        self.headlines.append(running_text(run.built.root))

    def close(self):
        self.closed = True


@pytest.fixture
def start(tmp_path):
    def started(*observers):
        Work.started = 0
        file = tmp_path / "tree.yaml"
        file.write_text(TREE)
        registry = Registry(skills={"work": Work})
        report = run(
            file, world=ScriptedWorld(), registry=registry, watch=lambda _: list(observers)
        )
        assert report.status == "SUCCESS"

    return started


def test_lines_show_phases_tries_and_what_is_done_about_a_failure(start):
    watcher = Watcher()
    start(watcher)
    seen = {line for frame in watcher.frames for line in frame}
    texts = {text for _, text, status in seen if status == "RUNNING"}
    assert any(text.endswith("SLIPPED, working") for text in texts)
    assert any("try 1" in text for text in texts)
    assert any("SLIPPED: work ticks 3 (1 of 1)" in text for text in texts)
    assert any(text.endswith("SLIPPED: SLIPPED") for _, text, s in seen if s == "FAILURE")
    assert any(h.startswith("work") and h.endswith("working") for h in watcher.headlines)
    assert watcher.headlines[-1] == "SUCCESS"
    assert watcher.closed


def test_nothing_runs_below_what_does_not(start):
    watcher = Watcher()
    start(watcher)
    for frame in watcher.frames:
        for (above, _, status), (below, text, inner) in itertools.pairwise(frame):
            if below > above and status != "RUNNING":
                assert inner != "RUNNING", text
    assert not any(status == "RUNNING" for _, _, status in watcher.frames[-1])


def test_plain_lines_tell_the_story_in_order(start):
    said = []
    start(ChangeLines(said.append))
    story = [line.split(" s ", 1)[1].strip() for line in said]
    assert story == [
        "Take starts",
        "work ticks 2, code SLIPPED starts",
        "work ticks 2, code SLIPPED fails: SLIPPED, it slipped",
        "recover: SLIPPED: work ticks 3 (1 of 1)",
        "work ticks 3 starts",
        "work ticks 3 done",
        "recover: try 2 of 2",
        "work ticks 2, code SLIPPED starts",
        "work ticks 2, code SLIPPED done",
        "Take done",
        "work ticks 2 starts",
        "work ticks 2 done",
    ]


@pytest.mark.parametrize("color", [True, False])
def test_the_live_tree_draws_and_obeys_no_color(start, monkeypatch, color):
    if not color:
        monkeypatch.setenv("NO_COLOR", "1")
    out = io.StringIO()
    live = LiveTree(Console(file=out, force_terminal=True, width=80))
    monkeypatch.setattr("momantu_bt.cli.run.live.REFRESH", 0.0)
    start(live)
    live.close()
    drawn = out.getvalue()
    assert "s simulated" in drawn
    assert "coming to rest" in drawn
    assert "recover: try 2 of 2" in drawn
    assert ("\x1b[1;36m" in drawn) == color


SCREENS = [(80, 24), (120, 40)]
DEEP = """
momantu_bt: 1
main: Main
trees:
  Main:
    - work: {ticks: 1}
    - recover:
        attempts: 3
        try:
          - sequence:
              - work: {ticks: 2}
              - work: {ticks: 4, code: SLIPPED}
            name: inner
        catch:
          SLIPPED:
            - work: {ticks: 2}
            - work: {ticks: 1}
    - work: {ticks: 2}
      timeout: 1 min
"""


@pytest.fixture
def screens(tmp_path, monkeypatch):
    """Run DEEP on a terminal; every picture that was drawn, and what stands there at the end."""
    monkeypatch.setattr("momantu_bt.cli.run.live.REFRESH", 0.0)

    def drawn(width, height, text=DEEP):
        Work.started = -2  # the third start of a skill slips
        file = tmp_path / "deep.yaml"
        file.write_text(text)
        out = io.StringIO()
        console = Console(file=out, force_terminal=True, width=width, height=height, no_color=True)
        live = LiveTree(console)
        pictures = []
        original = live._picture

        def picture():
            page = Console(file=io.StringIO(), width=width, height=height)
            page.print(original())
            pictures.append(page.file.getvalue().splitlines())
            return original()

        live._live._get_renderable = picture
        monkeypatch.setattr(live, "_picture", picture)
        registry = Registry(skills={"work": Work})
        run(file, world=ScriptedWorld(), registry=registry, watch=lambda _: [live])
        before = len(out.getvalue())
        live.close()
        assert len(out.getvalue()) == before, "closing twice prints nothing more"
        return pictures, out.getvalue()

    return drawn


@pytest.mark.parametrize("size", SCREENS)
def test_a_picture_fits_and_shows_structure_tries_handlers_and_events(screens, size):
    pictures, _ = screens(*size)
    assert max(len(picture) for picture in pictures) < size[1]
    assert max(len(line) for picture in pictures for line in picture) <= size[0]
    lines = [line.strip() for picture in pictures for line in picture]
    assert any("recover with 3 tries, try 1 of 3" in line for line in lines)
    assert any("recover with 3 tries, try 2 of 3" in line for line in lines)
    assert {"* try: sequence", "* inner: sequence"} <= set(lines)
    assert "on SLIPPED → work ticks 2, then work ticks 1" in lines
    assert "* on SLIPPED → sequence" in lines
    assert "work ticks 2  (at most 1 min)" in lines
    assert any("fails: SLIPPED, it slipped" in line for line in pictures[-3])


@pytest.mark.parametrize("size", SCREENS)
def test_after_the_end_all_events_and_the_tree_can_be_scrolled(screens, size):
    many = DEEP.replace("  Main:\n", "  Main:\n" + "    - work: {ticks: 1}\n" * 30)
    pictures, out = screens(*size, text=many)
    assert max(len(picture) for picture in pictures) < size[1]
    said = out[out.rindex("s simulated") - 20000 :] if len(out) > 20000 else out
    assert said.count("work ticks 1 starts") >= 30
    end = out[out.rindex("s simulated") :]
    assert end.count("work ticks 1") == 31


def test_while_it_is_prepared_the_tree_stands_with_what_is_prepared():
    out = io.StringIO()
    console = Console(file=out, force_terminal=True, width=80, height=24, no_color=True)
    live = LiveTree(console, [TreeLine(0, "sequence", "IDLE"), TreeLine(1, "wait 1 s", "IDLE")])
    assert "sequence" in out.getvalue()
    live.stage("opening the world four_rooms with the robot fetch")
    assert "preparing: opening the world four_rooms with the robot fetch … 0 s" in out.getvalue()
    before = out.getvalue().count("wait 1 s")
    deadline = time.monotonic() + 20.0
    while out.getvalue().count("wait 1 s") == before:
        assert time.monotonic() < deadline, "the picture is not drawn again"
        time.sleep(0.05)
    live.close()
    assert not any(thread.name == "first picture" for thread in threading.enumerate())
