"""Where two recorded runs part, and how they differ as a whole."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from momantu_bt.failure import FailureValue
from momantu_bt.replay.compare import compare
from momantu_bt.replay.difference import same, value_words
from momantu_bt.tree.files.settings import Given

TREE = """
values: {letters: RRS, far: 6}
trees:
  Main:
    - work: {script: $letters, to: $at}
      name: first
    - fallback:
        - condition: $at > 1
        - work: {script: RF}
        - drive: {ticks: $far}
"""


@pytest.fixture(scope="module")
def one(recorded):
    return recorded(TREE)


def test_a_run_equals_itself_and_its_repetition(recorded, one):
    for other in (one, recorded(TREE), recorded(TREE + "# a comment\n")):
        found = compare(one, other)
        assert found.equal
        assert found.first is found.parting is None
        assert found.outcome == found.nodes == ()


@settings(max_examples=25, suppress_health_check=list(HealthCheck), deadline=None)
@given(first=st.integers(0, 4), second=st.integers(0, 4), far=st.integers(1, 4))
def test_the_first_difference_is_where_the_runs_part(recorded, first, second, far):
    values = [{"letters": "R" * n + "S", "far": far} for n in (first, second)]
    left, right = (recorded(TREE, values=each) for each in values)
    found, back = compare(left, right), compare(right, left)
    assert found.equal == back.equal == (first == second)
    if first == second:
        return
    assert (found.first.tick, found.first.kind, found.first.where) == (0, "write", "letters")
    assert (found.first.left, found.first.right) == (back.first.right, back.first.left)
    assert found.given == (("value letters", "R" * first + "S", "R" * second + "S"),)


def other_tick(record, number, **changes):
    ticks = tuple(replace(t, **changes) if t.number == number else t for t in record.ticks)
    return replace(record, ticks=ticks)


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"now": 7.0}, "time"),
        ({"state": "0123"}, "robot state"),
        ({"reads": (("odometer", {"x": 1.0}),)}, "published value"),
        ({"writes": (("at", 3),)}, "write"),
        ({"issued": (("base", None),)}, "command"),
        ({"changes": ()}, "status"),
    ],
)
def test_every_kind_of_difference_is_told_with_its_tick(one, changes, kind):
    found = compare(one, other_tick(one, 3, **changes)).first
    assert (found.tick, found.kind) == (3, kind)
    assert found.left != found.right


def test_notes_and_failures_of_a_change_are_compared(one):
    for changed, kind in (({"note": "else"}, "note"), ({"status": "SKIPPED"}, "status")):
        change = replace(one.ticks[1].changes[0], **changed)
        other = other_tick(one, 1, changes=(change, *one.ticks[1].changes[1:]))
        assert compare(one, other).first.kind == kind


def test_data_and_causes_of_failures_count_but_not_where_files_lie():
    cause = FailureValue("OH", "no", {"n": 1, "traceback": "a.py"}, place="/a/t.yaml:3")
    here = FailureValue("OH", "no", {"n": 1}, cause=cause)
    elsewhere = {"n": 1, "traceback": "b.py"}
    moved = replace(here, cause=replace(cause, place="/b/t.yaml:3", data=elsewhere))
    assert same(here, moved)
    assert not same(here, replace(here, cause=replace(cause, data={"n": 2})))
    assert not same(here, replace(here, beside=(cause,)))
    assert not same(0.1, math.nextafter(0.1, 1.0))


def test_the_ways_part_in_words_and_the_counts_differ(recorded, one):
    other = recorded(TREE.replace("$at > 1", "$at > 2"))
    found = compare(one, other)
    assert found.first.kind == "status"
    assert found.parting.before.endswith("first: work script RRS, to $at done")
    assert found.parting.left == "nothing"
    assert found.parting.right.endswith("work script RF starts")
    names = [name for name, _, _ in found.outcome]
    assert names == ["sim_time_s", "ticks"]
    runs = {name.partition(" ")[2]: (left, right) for name, left, right in found.nodes}
    assert runs["work script RF (tree.yaml:11)"] == (
        "runs 0, failures 0, seconds 0",
        "runs 1, failures 1, seconds 0.05",
    )
    assert not any("first" in name for name in runs)


def test_trees_that_differ_are_told_with_their_texts(recorded, one):
    other = recorded(TREE.replace("condition: $at > 1", "succeed"))
    found = compare(one, other)
    assert found.first.kind == "tree"
    assert "condition" in found.first.left
    assert "succeed" in found.first.right
    lines = found.files["the tree"]
    assert "-        - condition: $at > 1" in lines
    assert "+        - succeed" in lines


def test_a_run_that_was_cut_off_ends_earlier(one):
    cut = replace(one, ticks=one.ticks[:4], report=None, complete=False)
    found = compare(one, cut)
    assert (found.first.kind, found.first.left) == ("end", "goes on")
    assert found.first.tick == one.ticks[4].number
    assert ("end", "nothing", "cut off") in found.outcome


def test_long_values_are_shown_from_where_they_part(one):
    long = tuple(range(500))
    left = other_tick(one, 2, writes=(("at", long),))
    right = other_tick(one, 2, writes=(("at", (*long[:-1], -1)),))
    found = compare(left, right).first
    assert found.left.endswith("499]")
    assert found.right.endswith("-1]")
    assert len(value_words(long)) == 200


def test_given_values_are_told_once_and_not_as_texts(recorded, one):
    given = Given()
    given.set(["letters=RS"])
    found = compare(one, recorded(TREE, values=given))
    assert ("value letters", "RRS", "RS") in found.given
    assert found.files == {}


def test_sites_are_compared_line_by_line_and_not_by_their_folders(one):
    def moved(folder, start):
        site = {"map_file": {"$path": f"{folder}/map.yaml"}, "start": start}
        return replace(one, files={**one.files, "site.json": json.dumps(site)})

    assert compare(moved("/a", 1.0), moved("/b", 1.0)).files == {}
    lines = compare(moved("/a", 1.0), moved("/b", 2.0)).files["site.json"]
    assert [line for line in lines if line[1:].startswith(' "start"')] == [
        '- "start": 1.0',
        '+ "start": 2.0',
    ]
