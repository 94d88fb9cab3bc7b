"""What a person sees of a record fits the window, whatever its size and whatever is shown."""

from __future__ import annotations

from io import StringIO

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console, ConsoleDimensions

from momantu_bt.cli.replay.screen import picture
from momantu_bt.replay.run_text import run_lines
from momantu_bt.replay.stepper import Stepper
from momantu_bt.replay.timeline import Timeline

TREE = """
values: {n: 0, long: "a value that is longer than most windows are wide, so that it must be cut 木"}
trees:
  Main:
    - work: {script: RRS}
      name: a name that is longer than a narrow window is wide
    - fallback:
        - work: {script: RF}
          name: first
        - work: {script: RRF}
          name: second
        - repeat:
            cycles: 3
            child:
              - script: $n += 1
              - work: {script: RRRS}
                name: deepest
"""
KEYS = ["right", "down", "up", "f", "F", "g", "G", "N", "n", "t", "b", "?", " ", "+", "enter", "x"]


@pytest.fixture(scope="module")
def timeline(recorded):
    return Timeline(recorded(TREE))


def drawn(stepper, width, height):
    """The lines of the window."""
    console = Console(width=width, height=height, file=StringIO(), color_system=None)
    lines = list(run_lines(stepper.timeline.recording))
    group = picture(stepper, lines, ConsoleDimensions(width, height))
    return ["".join(part.text for part in line) for line in console.render_lines(group, pad=False)]


def pressed(timeline, *keys):
    stepper = Stepper(timeline)
    for key in keys:
        stepper.press(key)
    return stepper


@settings(max_examples=100)
@given(st.lists(st.sampled_from(KEYS), max_size=12), st.integers(8, 130), st.integers(3, 60))
def test_it_is_never_higher_than_the_window(timeline, keys, width, height):
    """A line that is too wide would be wrapped, and take two."""
    assert len(drawn(pressed(timeline, *keys), width, height)) <= height


@pytest.mark.parametrize("height", [8, 12, 40])
@pytest.mark.parametrize("extra", ["", "b", "?"])
def test_what_runs_deepest_and_the_time_are_always_in_sight(timeline, height, extra):
    stepper = pressed(timeline, *extra)
    running = [
        index
        for index in range(len(timeline))
        for node in timeline.moment(index).nodes
        if (node.info.name, node.shown.value) == ("deepest", "RUNNING")
    ]
    assert running
    for stepper.index in running:
        lines = drawn(stepper, 100, height)
        assert f"{stepper.moment.tick.now:.2f} s of " in lines[0]
        assert any("deepest" in line for line in lines)


def test_failures_blackboard_keys_and_questions_are_told(timeline):
    assert any("✗ first" in line for line in drawn(pressed(timeline, "f"), 100, 30))
    assert any("n = 3" in line for line in drawn(pressed(timeline, "G", "b"), 100, 30))
    assert any("next, previous tick" in line for line in drawn(pressed(timeline, "?"), 100, 30))
    assert drawn(pressed(timeline, "n", "d", "e"), 100, 30)[-1] == "node: de▏"
    said = drawn(pressed(timeline, "t", "x", "enter"), 100, 30)[-1]
    assert said == "'x' is not a time; write seconds, such as 42.5"
    assert drawn(pressed(timeline), 100, 30)[-1] == "? for the keys, q to leave"
