"""Going through a record: by ticks, changes, time, nodes and failures."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from momantu_bt.cli.shared.keyboard import keys_in
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.replay.moment_text import board_lines, failures_of, moment_data
from momantu_bt.replay.seek import SeekError, changes, failures, matching
from momantu_bt.replay.stepper import KEYS, SPEEDS, Stepper
from momantu_bt.replay.timeline import EVERY, Timeline

TREE = """
values: {n: 0}
trees:
  Main:
    - Take: {letters: RRRS}
    - script: $n := 1
    - fallback:
        - work: {script: RF}
          name: hard
        - work: {script: RRF}
        - wait: 5 s
  Take:
    inputs: {letters: text}
    sequence:
      - work: {script: $letters}
"""


@pytest.fixture(scope="module")
def timeline(recorded):
    return Timeline(recorded(TREE))


@pytest.fixture
def stepper(timeline):
    return Stepper(timeline)


def press(stepper, *keys):
    for key in keys:
        stepper.press(key)
    return stepper


def write(stepper, text):
    return press(stepper, *text, "enter")


def test_each_instant_is_the_same_however_one_comes_there(timeline):
    assert len(timeline) > EVERY
    forwards = [moment_data(timeline.moment(index)) for index in range(len(timeline))]
    fresh = Timeline(timeline.recording)
    assert [moment_data(fresh.moment(i)) for i in reversed(range(len(fresh)))] == forwards[::-1]


def test_the_tree_is_drawn_with_notes_values_and_reasons(timeline):
    def lines(time):
        return [line.text for line in tree_lines(timeline.moment(timeline.at(time)).root)]

    assert "work script RRRS, part 1" in lines(0.1)
    assert "Take letters RRRS" in lines(0.1)
    assert "hard: work script RF: OH" in lines(1.0)


def test_the_blackboard_is_that_of_the_instant(timeline):
    assert timeline.moment(0).board == {"n": 0}
    later = timeline.moment(timeline.at(3.0))
    assert later.board["n"] == 1
    assert next(m for m in map(timeline.moment, range(99)) if m.board["n"] == 1).written == ("n",)


def test_keys_of_subtrees_are_named_by_the_subtree_where_that_is_enough(recorded):
    take = "Take: {inputs: {n: int}, sequence: [{repeat: {cycles: $n, child: succeed}}]}"
    put = take.replace("Take", "Put")
    trees = f"trees:\n  Main: [Put: {{n: 1}}, Take: {{n: 2}}, Take: {{n: 3}}]\n  {take}\n  {put}"
    timeline = Timeline(recorded(trees))
    names = [words for _, words in board_lines(timeline.moment(len(timeline) - 1))]
    assert names == ["Put/n = 1", "0.1/Take/n = 2", "0.2/Take/n = 3"]


@settings(max_examples=50)
@given(
    keys=st.lists(st.sampled_from(["right", "left", "up", "down", "f", "F", "g", "G", "N", "x"]))
)
def test_no_key_leaves_the_record(timeline, keys):
    stepper = press(Stepper(timeline), *keys)
    assert 0 <= stepper.index < len(timeline)
    assert stepper.moment.index == stepper.index


def test_down_and_up_go_from_change_to_change(timeline, stepper):
    visited = []
    while not stepper.said:
        visited.append(press(stepper, "down").index)
    assert visited[:-1] == changes(timeline.recording)
    assert stepper.said == "no later change"
    assert press(stepper, "up").index == visited[-3]


def test_failures_are_found_where_they_began(timeline, stepper):
    found = failures(timeline.recording)
    assert [(at.node.name, at.failure.code) for at in found] == [("hard", "OH"), ("work", "OH")]
    assert press(stepper, "f").said.startswith("failure 1 of 2: hard: OH")
    assert failures_of(stepper.moment)[0].node == "hard"
    press(stepper, "f")
    assert stepper.index == found[1].index
    assert press(stepper, "f").said == "no later failure"
    assert press(stepper, "F").index == found[0].index


def test_times_and_nodes_are_typed(timeline, stepper):
    assert press(stepper, "t", "9", "backspace", "1", "x", "backspace").prompt == "time in s: 1"
    assert press(stepper, "enter").moment.tick.now == pytest.approx(1.0)
    assert stepper.prompt is None
    for text in ("soon", "nan", ""):
        assert write(press(stepper, "t"), text).said.startswith(f"{text!r} is not a time")
    write(press(stepper, "g", "n"), "wait")
    assert "wait" in {stepper.moment.nodes[c.node].name for c in stepper.moment.tick.changes}
    at = stepper.index
    press(stepper, "n", "enter")
    assert stepper.index > at
    assert press(stepper, "N").index == at
    assert press(stepper, "n", "q", "escape").prompt is None
    assert not stepper.leaving


def test_what_is_not_there_is_said_with_what_is(timeline, stepper):
    assert "did you mean wait" in write(press(stepper, "n"), "wiat").said
    assert stepper.index == 0
    with pytest.raises(SeekError, match="one does in line 7"):
        matching(timeline.recording, "3")
    assert matching(timeline.recording, "7")[0].name == "Take"


def test_playing_takes_the_record_along_at_its_speed(timeline, stepper):
    press(stepper, " ")
    stepper.pass_time(1.0)
    assert stepper.moment.tick.now == pytest.approx(1.0)
    press(stepper, "+", "+")
    assert stepper.speed == 4.0
    stepper.pass_time(0.25)
    assert stepper.moment.tick.now == pytest.approx(2.0)
    press(stepper, " ")
    stepper.pass_time(1.0)
    assert stepper.moment.tick.now == pytest.approx(2.0)
    press(stepper, " ", *"+" * 9)
    assert stepper.speed == SPEEDS[-1]
    stepper.pass_time(99.0)
    assert stepper.index == len(timeline) - 1
    assert not stepper.playing


def test_every_key_that_is_told_means_something(timeline):
    for names in KEYS:
        for name in names.split() if names != "space" else [" "]:
            key = {"→": "right", "←": "left", "↓": "down", "↑": "up"}.get(name, name)
            stepper = press(Stepper(timeline, start=9), key)
            seen = (stepper.index, stepper.playing, stepper.speed, stepper.said, stepper.prompt)
            shown = (stepper.shows_board, stepper.shows_keys, stepper.leaving)
            assert (seen, shown) != ((9, False, 1.0, "", None), (False, False, False)), name


@pytest.mark.parametrize("before", ["", "t"])
def test_the_end_of_the_input_leaves_also_from_a_prompt(timeline, before):
    assert press(Stepper(timeline), *before, "leave").leaving


def test_terminals_keys():
    assert keys_in("a\x1b[C\x1bOA\x1b[1;5C \r\x7f") == [
        "a",
        "right",
        "up",
        " ",
        "enter",
        "backspace",
    ]
    assert keys_in("\x1b") == ["escape"]
    assert keys_in("\x04") == ["leave"]
