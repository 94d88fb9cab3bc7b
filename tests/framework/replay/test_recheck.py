"""A record's tree does the same again, and a record in which something was changed is found."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, assume, given, reject, settings
from hypothesis import strategies as st

from momantu_bt.replay.rebuild import RebuildError
from momantu_bt.replay.recheck import recheck
from momantu_bt.tree.load import TreeError
from momantu_bt.tree.registry import Registry
from tests.framework.tree.test_soundness import KEYS, LEAVES, _branched, _listed

WORKING = st.tuples(st.sampled_from(["S", "F", "RS", "RF", "RRRS", "RRRRRR"]), KEYS).map(
    lambda t: f"{{work: {{script: {t[0]}, to: ${t[1]}}}}}"
)
NODES = st.recursive(
    st.one_of(LEAVES, WORKING, WORKING),
    lambda node: st.one_of(_listed(node), _branched(node)),
    max_leaves=10,
)


@st.composite
def trees_at_work(draw):
    """A tree in which skills work between the built-in nodes."""
    nodes = ", ".join(draw(st.lists(NODES, min_size=1, max_size=4)))
    return f"values: {{a: 1, b: 3}}\ntrees:\n  Main: [{nodes}]\n"


EXAMPLES = settings(max_examples=60, suppress_health_check=list(HealthCheck), deadline=None)


def random_record(recorded, text):
    try:
        return recorded(text, max_time=1.0)
    except TreeError:
        reject()


@EXAMPLES
@given(text=trees_at_work())
def test_random_trees_do_the_same_again(recorded, registry, text):
    record = random_record(recorded, text)
    again = recheck(record, registry)
    assert again.difference is None
    assert again.ticks == record.report["ticks"]


def other_status(change):
    status = "SUCCESS" if change.status != "SUCCESS" else "FAILURE"
    return replace(change, status=status, note="", failure=None)


@EXAMPLES
@given(text=trees_at_work(), choice=st.randoms(use_true_random=False), drop=st.booleans())
def test_a_changed_status_is_found_in_its_tick(recorded, registry, text, choice, drop):
    record = random_record(recorded, text)
    at = choice.choice([i for i, tick in enumerate(record.ticks) if tick.changes])
    changes = list(record.ticks[at].changes)
    which = choice.randrange(len(changes))
    if drop:
        del changes[which]
    else:
        changes[which] = other_status(changes[which])
    found = recheck(with_tick(record, at, changes=tuple(changes)), registry).difference
    assert found is not None
    assert found.tick == record.ticks[at].number
    assert found.kind == "status"


@EXAMPLES
@given(text=trees_at_work(), choice=st.randoms(use_true_random=False))
def test_another_value_is_found_in_its_tick(recorded, registry, text, choice):
    record = random_record(recorded, text)
    writing = [i for i, tick in enumerate(record.ticks) if tick.writes]
    assume(len(writing) > 1)
    at = choice.choice(writing)
    writes = list(record.ticks[at].writes)
    which = choice.randrange(len(writes))
    writes[which] = (writes[which][0], "another value")
    found = recheck(with_tick(record, at, writes=tuple(writes)), registry).difference
    assert (found.tick, found.kind) == (record.ticks[at].number, "write")
    assert found.left == "another value"


def with_tick(record, at, **changes):
    ticks = list(record.ticks)
    ticks[at] = replace(ticks[at], **changes)
    return replace(record, ticks=tuple(ticks))


EVERYTHING = """
values: {n: 0}
trees:
  Main:
    - ask: {question: "Which?", choices: [red, blue], answer: $said}
    - confirm: {question: "Really?"}
      force: success
    - parallel:
        success_count: 1
        children:
          - drive: {ticks: 60}
          - work: {script: F}
            distance_controller: 0.5 m
            force: success
            repeat: -1
          - wait: 0.4 s
            speed_controller: {min_rate: 1, max_rate: 10, min_speed: 0, max_speed: 1}
            repeat: -1
          - script: $n := $@odometer.x
            while: $@robot.linear > -1
            repeat: -1
      timeout: 2 s
      force: success
    - recover:
        attempts: 3
        try: [{Inner: {times: $n}}]
        catch:
          any: [{work: {script: RRS, to: $told}}]
  Inner:
    inputs: {times: any}
    sequence:
      - work: {script: RRRRF}
        timeout: 0.15 s
        on_halt: $@n := 7
"""


@pytest.fixture(scope="module")
def everything(recorded):
    return recorded(EVERYTHING, answers=["red", False], max_time=20.0)


def test_questions_services_odometry_timeouts_recoveries_and_halts(everything, registry):
    again = recheck(everything, registry)
    assert again.difference is None
    assert again.ticks == everything.report["ticks"] > 40
    read = {key for tick in everything.ticks for key, _ in tick.reads}
    assert read == {"a person", "odometry's position", "odometry's speed", "odometer", "robot"}


def last(record, has):
    """The last tick before the coming to rest that has something."""
    return max(i for i, tick in enumerate(record.ticks) if has(tick) and not tick.settling)


def test_another_result_of_a_skill_shows_where_it_leads(everything, registry):
    at = last(everything, lambda tick: any(cell == "told" for cell, _ in tick.writes))
    steps = [replace(step, outputs={"to": 99}) for step in everything.ticks[at].steps]
    found = recheck(with_tick(everything, at, steps=tuple(steps)), registry).difference
    assert (found.tick, found.kind) == (everything.ticks[at].number, "write")
    assert found.right == "99"
    assert "told" in found.where


def test_what_nobody_told_and_what_nobody_asks_for_are_found(everything, registry):
    at = last(everything, lambda tick: tick.steps)
    number, steps = everything.ticks[at].number, everything.ticks[at].steps
    untold = recheck(with_tick(everything, at, steps=()), registry).difference
    assert (untold.tick, untold.kind) == (number, "outside")
    assert untold.where.startswith("work")
    twice = recheck(with_tick(everything, at, steps=(*steps, *steps)), registry).difference
    assert (twice.tick, twice.kind, twice.right) == (number, "outside", "nothing")


def test_another_phase_shows_in_the_words_of_a_timeout(everything, registry):
    before = [
        i
        for i, tick in enumerate(everything.ticks)
        if any(change.failure and change.failure.code == "TIMEOUT" for change in tick.changes)
    ]
    at = before[-1] - 1
    steps = [replace(step, phase="dreaming") for step in everything.ticks[at].steps]
    found = recheck(with_tick(everything, at, steps=tuple(steps)), registry).difference
    assert found.kind == "failure"
    assert "dreaming" in found.right
    assert "part" in found.left


def test_a_run_that_a_person_leaves_is_the_same_up_to_there(recorded, registry):
    tree = 'trees: {Main: [{wait: 0.1}, {ask: {question: "Which?", answer: $a}}]}'
    record = recorded(tree, answers=["red"])
    at = last(record, lambda tick: tick.reads)
    left = with_tick(record, at, reads=(), writes=(), changes=record.ticks[at].changes[:2])
    # the tick in which nothing was answered is the last one, and its tree is still running
    cut = replace(left, ticks=left.ticks[: at + 1], report=None, complete=False)
    assert recheck(cut, registry).difference is None


RULES = """momantu_bt: 1
substitute:
  - {node: far, status: FAILURE, code: OH, delay: 0.2 s, times: 1}
  - {node: far, status: SUCCESS, outputs: {to: 5}}
"""


def test_substituted_nodes_and_given_values(recorded, registry, tmp_path):
    rules = tmp_path / "rules.yaml"
    rules.write_text(RULES, encoding="utf-8")
    tree = """
values: {letters: RF}
trees:
  Main:
    - {work: {script: $letters, to: $a}, name: far, retry: 2}
    - {work: {script: $letters, to: $a}}
    - {condition: $a > 1}
"""
    record = recorded(tree, substitute=rules, values={"letters": "RRRRS"})
    assert record.report["status"] == "SUCCESS"
    assert recheck(record, registry).difference is None


def test_included_files_are_found_again_wherever_they_lay(recorded, registry, tmp_path):
    shared = tmp_path / "project" / "shared"
    shared.mkdir(parents=True)
    (tmp_path / "project" / "pyproject.toml").touch()
    inner = "momantu_bt: 1\ntrees:\n  Inner: [{work: {script: RRS}}]\n"
    (shared / "inner.yaml").write_text(inner, encoding="utf-8")
    (tmp_path / "project" / "trees").mkdir()
    text = "include: [../shared/inner.yaml]\ntrees: {Main: [Inner]}"
    record = recorded(text, folder=tmp_path / "project" / "trees")
    assert recheck(record, registry).difference is None
    gone = {name: text for name, text in record.files.items() if "inner" not in name}
    kinds = {name: record.kinds[name] for name in gone}
    with pytest.raises(RebuildError, match="inner.yaml"):
        recheck(replace(record, files=gone, kinds=kinds), registry)


def test_a_record_without_its_tree_and_one_of_another_tree_say_so(everything, registry):
    none = replace(everything, files={}, kinds={})
    with pytest.raises(RebuildError, match="no site"):
        recheck(none, registry)
    with pytest.raises(RebuildError, match=r"tree.yaml:14: no node is called 'work'"):
        recheck(everything, Registry(services=registry.services))
    name = everything.about["tree"]
    other = everything.files[name].replace("RRRRF", "RRF").replace("- confirm:", "- # confirm:")
    changed = other.replace("      force: success\n    - parallel", "    - parallel")
    files = {
        **everything.files,
        name: changed.replace('    - # confirm: {question: "Really?"}', ""),
    }
    found = recheck(replace(everything, files=files), registry).difference
    assert (found.kind, found.tick) == ("tree", 0)


def test_names_of_files_lead_nowhere_else(everything, registry):
    name = everything.about["tree"]
    text = everything.files[name]
    for bad in ("a/../../../../x.yaml", "../" * 3 + "x.yaml"):
        files = {**everything.files, bad: text}
        kinds = {**everything.kinds, bad: "tree"}
        record = replace(everything, files=files, kinds=kinds)
        assert recheck(record, registry).difference is None


FRAGILE = """
trees:
  Main:
    - recover:
        attempts: 3
        try: [{drive: {ticks: 5}}, {work: {script: RRRS, to: $n}}, {wait: 0.1 s}]
        catch: {any: again}
"""


@pytest.mark.parametrize("fault", ["skill.exception@work", "skill.nan@work", "base.stuck@drive"])
def test_what_was_broken_on_purpose_is_in_the_record(recorded, registry, fault):
    record = recorded(FRAGILE, faults=(fault,))
    assert record.report["faults"][0]["began"] is not None
    assert recheck(record, registry).difference is None
