"""The live tree and the plain lines: what a person sees, and that nothing seen is stale."""

from __future__ import annotations

import io
import itertools

import pytest
from rich.console import Console

from momantu_bt.cli.run.live import LiveTree
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.running.api import run
from momantu_bt.skill import Failure, In, Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry

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
