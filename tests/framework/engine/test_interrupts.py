"""Signals: noted, obeyed between two ticks, and handed back to whoever had them before."""

from __future__ import annotations

import signal

import pytest

from momantu_bt.engine.interrupts import Interrupts

NUMBERS = [signal.SIGINT, signal.SIGTERM]


@pytest.fixture(autouse=True)
def _as_before():
    before = {number: signal.getsignal(number) for number in NUMBERS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", NUMBERS)
def test_before_the_first_tick_a_signal_ends_it_at_once(number):
    with Interrupts() as interrupts, pytest.raises(KeyboardInterrupt):
        signal.raise_signal(number)
    assert interrupts.requested


@pytest.mark.parametrize("first", NUMBERS)
@pytest.mark.parametrize("second", NUMBERS)
def test_the_first_waits_for_the_tick_and_the_second_does_not(first, second):
    with Interrupts() as interrupts:
        interrupts.patient = True
        signal.raise_signal(first)
        assert interrupts.requested
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(second)


def test_handlers_are_given_back_also_after_an_exception_and_when_nested():
    heard = []
    signal.signal(signal.SIGINT, lambda number, frame: heard.append("mine"))
    with pytest.raises(RuntimeError), Interrupts():
        raise RuntimeError
    signal.raise_signal(signal.SIGINT)
    with Interrupts() as outer:
        outer.patient = True
        with Interrupts() as inner:
            inner.patient = True
            signal.raise_signal(signal.SIGINT)
        assert (inner.requested, outer.requested) == (True, False)
        signal.raise_signal(signal.SIGINT)
        assert outer.requested
    signal.raise_signal(signal.SIGINT)
    assert heard == ["mine", "mine"]


def test_an_ignored_signal_is_ignored_again_afterwards():
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    with Interrupts():
        pass
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
