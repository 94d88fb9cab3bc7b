"""What a person sees while a bench runs."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from collections.abc import Generator, Iterable
from pathlib import Path
from typing import Any

import pytest

from momantu_bt.bench.rows.spec import EpisodeSpec, Row
from momantu_bt.bench.rows.store import read_rows
from momantu_bt.cli.bench.progress import Progress, duration


class Still:
    """An engine that has some episodes under way for good."""

    workers = 2

    def __init__(self, *seeds: int) -> None:
        self.seeds = seeds

    def running(self) -> tuple[EpisodeSpec, ...]:
        return tuple(EpisodeSpec("k", "t.yaml", seed) for seed in self.seeds)

    def run(self, specs: Iterable[EpisodeSpec]) -> Generator[Row, None, None]:
        yield from ()


def row(seed: int, *, good: bool = True) -> dict[str, Any]:
    status = "SUCCESS" if good else "FAILURE"
    figures = {"sim_time_s": 80.0, "process_time_s": 60.0, "memory_mb": 900.0}
    failure = {"code": "LOST", "node": "Put", "place": "t.yaml:3", "cause": None}
    told = {"tree": "t.yaml", "seed": seed, "fault": None, "outcome": None, "ended": "report"}
    return {**told, "status": status, "success": good, "failure": failure, **figures}


def test_the_headline_says_how_far_how_good_and_how_long(
    capsys: pytest.CaptureFixture[str],
) -> None:
    shown = Progress()
    shown.begin([row(0), row(1)], 6, Still(2, 3))
    shown.row(row(2))
    shown.row(row(3, good=False))
    said = capsys.readouterr().out
    assert "2 episodes are there already; 6 to run, 2 at a time" in said
    assert "[2/6] t.yaml seed 3: FAILED" in said
    assert "LOST in Put (t.yaml:3)" in said
    headline = shown.headline()
    assert headline.startswith("4 of 8, 3 successes (30.1 % to 95.4 %), ")
    assert "2 min left" in headline
    assert headline.endswith("running seed 2, seed 3")


def test_nothing_is_foretold_of_nothing() -> None:
    shown = Progress()
    shown.begin([], 3, Still())
    assert "left" not in shown.headline()


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0, "0 s"), (45, "45 s"), (720, "12 min"), (12000, "3 h 20 min"), (7170, "2 h 0 min")],
)
def test_durations(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_a_terminal_gets_one_line_that_goes_and_the_figures_that_stay(
    small: str, tmp_path: Path
) -> None:
    ours, theirs = pty.openpty()
    words = ["-m", "momantu_bt", "bench", small, "--seeds", "0:3", "--out", str(tmp_path / "out")]
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120"}
    bench = subprocess.Popen(
        [sys.executable, *words], stdout=theirs, stderr=theirs, stdin=theirs, env=environment
    )
    os.close(theirs)
    said = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        said += piece
    os.close(ours)
    assert bench.wait(timeout=60) == 0
    text = said.decode()
    assert "0 of 3, 0 successes" in text
    assert "running seed 0" in text
    assert "[1/3]" not in text
    assert "3 of 3, 100.0 %" in text
    assert len(read_rows(tmp_path / "out")) == 3
