"""What a person sees while a map is made."""

from __future__ import annotations

import io
from types import SimpleNamespace

import pytest
from momantu_skills.mapping import progress
from momantu_skills.mapping.building import build
from momantu_skills.mapping.survey import Survey
from rich.console import Console

from momantu_bt.failure import SENSOR_DEAD, Failure
from momantu_bt.geometry import Pose2D
from tests.skills.mapping.plans import drawn
from tests.skills.mapping.walls import RING, ROUND, driven, logged


@pytest.fixture
def terminal(monkeypatch):
    """A terminal of 60 columns and 24 rows, and no time between two pictures."""
    written = io.StringIO()
    monkeypatch.setattr(
        progress,
        "Console",
        lambda file: Console(file=written, force_terminal=True, width=60, height=24),
    )
    monkeypatch.setattr(progress, "REDRAWN", 0.0)
    return written


def test_a_log_shows_bar_loops_area_and_the_map_that_grows(terminal):
    scans, survey = logged(driven(ROUND, 0.5), 1), Survey()
    with progress.Scans(len(scans), survey) as told:
        build(scans, 0.05, told, survey)
    said = terminal.getvalue()
    assert f"{len(scans)} of {len(scans)} scans" in said
    assert "square metres known" in said
    assert "━" in said
    assert said.count("█") > 1000
    assert "@" in said


def test_an_exploration_shows_clock_loops_area_and_the_map(terminal):
    mapping = SimpleNamespace(
        known=12.3,
        loops=2,
        map_from_base=Pose2D(1.5, 1.5),
        survey=SimpleNamespace(mapper=SimpleNamespace(poses=[Pose2D(1.5, 1.5)])),
        costmap=SimpleNamespace(grid=drawn(RING)),
    )
    with progress.Exploration() as told:
        told(7.0, mapping)
    said = terminal.getvalue()
    assert "7.0 s  12.3 square metres known, 2 loops" in said
    assert "█" in said
    assert "@" in said


def test_before_the_first_scan_there_is_no_map_to_show(terminal):
    class Blind:
        known, loops, map_from_base = 0.0, 0, Pose2D(0.0, 0.0)
        survey = SimpleNamespace(mapper=SimpleNamespace(poses=[]))

        @property
        def costmap(self):
            raise Failure(SENSOR_DEAD, "there is no map yet")

    with progress.Exploration() as told:
        told(0.0, Blind())
    assert "0.0 square metres known" in terminal.getvalue()


def test_scans_that_are_laid_show_a_bar(terminal):
    with progress.Laid() as laid:
        for done in range(1, 8):
            laid(done, 7)
    said = terminal.getvalue()
    assert "7 of 7 scans are laid on those before" in said
    assert "━" in said


def test_where_no_scans_are_laid_nothing_is_shown(terminal, capsys):
    with progress.Laid():
        pass
    assert terminal.getvalue() == "" == capsys.readouterr().err


def test_without_a_terminal_lines_tell_how_many_scans_are_laid(capsys):
    with progress.Laid() as laid:
        for done in range(1, 201):
            laid(done, 200)
    lines = capsys.readouterr().err.splitlines()
    assert 19 <= len(lines) <= 20
    assert lines[0] == "10 of 200 scans are laid on those before"


def test_without_a_terminal_lines_are_printed(capsys):
    scans, survey = logged(driven(ROUND[:3], 0.5), 1), Survey()
    with progress.Scans(len(scans), survey, "the log alone: ") as told:
        build(scans, 0.05, told, survey)
    said = capsys.readouterr().err
    assert said.count("the log alone: ") == said.count(f" of {len(scans)} scans, ") >= 15
    assert "\x1b" not in said
