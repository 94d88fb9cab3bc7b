"""The garbage collector during a run: off while it starts, and back as it was afterwards."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref

import pytest

from momantu_bt import collector


class Loop:
    """An object that refers to itself: the collector alone can free it."""

    def __init__(self) -> None:
        self.itself = self


def fail_in_both() -> None:
    with collector.paused():
        assert not gc.isenabled()
        with collector.frozen():
            assert gc.isenabled()
            assert gc.get_freeze_count() > 0
            raise KeyError


@pytest.mark.parametrize("was_on", [True, False])
def test_afterwards_it_is_as_before(was_on: bool) -> None:
    (gc.enable if was_on else gc.disable)()
    try:
        with pytest.raises(KeyError):
            fail_in_both()
        assert gc.isenabled() is was_on
        assert gc.get_freeze_count() == 0
    finally:
        gc.enable()


def test_what_was_there_is_freed_after_the_run_and_garbage_of_the_run_during_it() -> None:
    before = Loop()
    early = weakref.ref(before)
    with collector.frozen():
        del before
        within = weakref.ref(Loop())
        gc.collect()
        assert within() is None
        assert early() is not None
    gc.collect()
    assert early() is None


def test_a_program_collects_seldom_and_its_run_as_often_as_usual() -> None:
    usual = gc.get_threshold()
    with collector.seldom():
        assert gc.get_threshold()[0] > usual[0]
        with collector.frozen():
            assert gc.get_threshold() == usual
        assert gc.get_threshold()[0] > usual[0]
    assert gc.get_threshold() == usual


def test_who_has_switched_it_off_keeps_it_off() -> None:
    usual = gc.get_threshold()
    gc.set_threshold(0)
    try:
        with collector.seldom():
            assert gc.get_threshold()[0] == 0
    finally:
        gc.set_threshold(*usual)


@pytest.mark.parametrize(("said", "collections"), [("", 1), ("collector.skip_the_last()\n" * 2, 0)])
def test_the_collection_at_the_end_of_a_process_may_be_left_out(
    said: str, collections: int
) -> None:
    program = (
        "import weakref\nfrom momantu_bt import collector\n"
        f"{said}"
        "class Loop:\n"
        "    def __init__(self): self.itself = self\n"
        "    def __del__(self, say=print): say('collected')\n"
        "Loop()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.count("collected") == collections
