"""The pace of a run: never faster than real time, also after a delay."""

from __future__ import annotations

import time

import pytest

from momantu_bt.engine.pace import LATE, Pace


@pytest.fixture
def wall(monkeypatch):
    """The wall clock, which only sleeping and the test move."""
    now = [100.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: now.append(now.pop() + seconds))
    return now


def test_it_waits_for_the_wall_clock(wall):
    pace = Pace()
    for tick in range(1, 21):
        pace.hold(tick * 0.05)
        assert wall[0] == pytest.approx(100.0 + tick * 0.05)


def test_a_short_delay_is_caught_up(wall):
    pace = Pace()
    wall[0] += LATE - 0.01
    pace.hold(0.05)
    pace.hold(0.2)
    assert wall[0] == pytest.approx(100.2)


def test_after_a_long_delay_it_goes_on_at_the_same_pace(wall):
    pace = Pace()
    wall[0] += 7.0
    pace.hold(0.05)
    for tick in range(2, 12):
        before = wall[0]
        pace.hold(tick * 0.05)
        assert wall[0] - before == pytest.approx(0.05)
