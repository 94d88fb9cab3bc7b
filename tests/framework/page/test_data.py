"""What the page shows of a record, as plain data."""

import math
from dataclasses import replace

import numpy as np
import pytest

from momantu_bt.engine.role import Role
from momantu_bt.failure import FailureValue
from momantu_bt.page.data import page_data
from momantu_bt.page.tables import WIDEST, value_text
from momantu_bt.record.codec import Opaque
from momantu_bt.record.recording import TickRecord
from momantu_bt.skill import MISSING
from tests.framework.page.conftest import STORY


@pytest.fixture(scope="module")
def data(recording):
    return page_data(recording())


def test_the_head_tells_how_it_ended(data, recording):
    about = data["about"]
    assert about["title"] == "bring"
    assert about["outcome"]["kind"] == "bad"
    assert about["outcome"]["sentence"].startswith(
        "GRASP_MISSED, the fingers closed on nothing <- "
    )
    assert ["seed", "3"] in about["facts"]
    assert about["warning"] == ""


def test_a_record_that_is_cut_off_says_so(recording):
    about = page_data(recording(report=None, complete=False))["about"]
    assert about["outcome"]["words"] == "cut off"
    assert "after 4.95 s" in about["warning"]


@pytest.mark.parametrize(
    ("status", "success", "kind", "words"),
    [
        ("SUCCESS", None, "good", "SUCCESS"),
        ("SUCCESS", True, "good", "SUCCESS, the referee agrees"),
        ("SUCCESS", False, "bad", "SUCCESS, the referee denies it"),
        ("FAILURE", True, "bad", "FAILURE, the referee sees success"),
        ("INTERRUPTED", False, "bad", "INTERRUPTED"),
        ("ERROR", None, "bad", "ERROR"),
    ],
)
def test_outcomes_in_words(recording, status, success, kind, words):
    report = {**recording().report, "status": status, "success": success, "error": "Boom\nat x"}
    outcome = page_data(recording(report=report))["about"]["outcome"]
    assert (outcome["kind"], outcome["words"]) == (kind, words)


def test_a_failure_that_no_node_had_is_told_from_the_report(recording):
    cause = FailureValue("HALTED", "was running", node="pick", place="bring.yaml:7")
    late = FailureValue("TIMEOUT", "600 s are over", cause=cause)
    report = {**recording().report, "failure": late.as_dict()}
    data = page_data(recording(report=report, story={0: STORY[0]}))
    sentence = "TIMEOUT, 600 s are over <- the tree <- pick (bring.yaml:7): HALTED, was running"
    assert data["about"]["outcome"]["sentence"] == sentence
    (failure,) = data["failures"]
    assert (failure["tick"], [link["at"] for link in failure["links"]]) == (99, [-1, 4])


def test_lanes_are_skills_then_failures(data):
    assert [lane["name"] for lane in data["lanes"]] == [
        "navigate",
        "pick",
        "reset_pose",
        "failures",
    ]
    navigate, pick, _, failures = (lane["bars"] for lane in data["lanes"])
    assert [(bar["begin"], bar["end"], bar["status"]) for bar in navigate] == [(0, 40, 2)]
    assert [(bar["begin"], bar["end"], bar["status"]) for bar in pick] == [(40, 60, 3), (81, 99, 3)]
    assert navigate[0]["words"].splitlines() == [
        "navigate in_front_of table_a (bring.yaml:4)",
        "0.00 s to 2.00 s (2.00 s)",
        "plan, follow",
        "succeeded",
    ]
    assert [bar["begin"] for bar in failures] == [60, 99]


def test_what_still_runs_at_the_end_has_a_bar_until_then(recording):
    story = {3: [(4, "RUNNING", "", None)]}
    bar = page_data(recording(story=story, ticks=10))["lanes"][0]["bars"][0]
    assert (bar["begin"], bar["end"], bar["status"]) == (3, 9, 1)


def test_faults_on_purpose_have_a_lane(recording):
    faults = [
        {"fault": "camera.dead", "began": 1.0, "ended": 2.0},
        {"fault": "arm.stuck", "began": 3.0, "ended": None},
        {"fault": "never.met", "began": None, "ended": None},
    ]
    lane = page_data(recording(report={**recording().report, "faults": faults}))["lanes"][-1]
    assert lane["kind"] == "faults"
    assert [(bar["begin"], bar["end"]) for bar in lane["bars"]] == [(20, 40), (60, 99)]


def test_incidents_and_denied_claims_are_marked(recording):
    lie = {"time": 2.0, "place": "bring.yaml:7", "code": None, "claim": "holds something"}
    told = {
        "incidents": [{"time": 1.0, "kind": "force", "sentence": "200 N at the wrist"}],
        "claims": {"pick": {"lies": [lie]}},
    }
    lanes = page_data(recording(report={**recording().report, **told}))["lanes"]
    named = {lane["name"]: lane["bars"] for lane in lanes}
    (force,), (denied,) = named["incidents"], named["denied claims"]
    assert (force["begin"], force["words"]) == (20, "force: 200 N at the wrist")
    assert (denied["begin"], denied["end"]) == (40, 40)
    assert denied["words"] == "pick (bring.yaml:7): SUCCESS, but not so: holds something"


def test_failures_are_the_outermost_of_their_tick_with_the_whole_chain(data):
    first, last = data["failures"]
    assert (first["tick"], first["node"], first["links"][0]["at"]) == (60, 4, 4)
    assert [link["at"] for link in last["links"]] == [0, 3, 4]
    assert [link["depth"] for link in last["links"]] == [0, 1, 2]
    assert [link["code"] for link in last["links"]] == ["GRASP_MISSED", "", ""]
    assert last["links"][1]["tries"] == "2 of 2 tries"
    assert last["links"][2]["data"] == [["width", "0"]]


def test_a_node_of_a_subtree_that_is_used_twice_is_the_one_that_failed(recording):
    inner = FailureValue("A", "no", node="inner", place="bring.yaml:9")
    outer = FailureValue("A", "no", node="twice", place="bring.yaml:2", cause=inner)
    nodes = [
        ("top", "T", 0, None, "top", 1),
        ("twice", "T", 1, 0, "twice", 2),
        ("inner", "x", 2, 1, "", 9),
        ("twice", "T", 1, 0, "twice", 3),
        ("inner", "x", 2, 3, "", 9),
    ]
    story = {1: [(4, "FAILURE", "", inner)], 2: [(1, "FAILURE", "", outer)]}
    first, second = page_data(recording(nodes=nodes, story=story, report=None))["failures"]
    assert [link["at"] for link in first["links"]] == [4]
    assert [link["at"] for link in second["links"]] == [1, 2]


def test_siblings_that_were_tried_before_are_in_the_chain_and_long_chains_end(recording):
    beside = FailureValue("A", "first", node="pick", place="bring.yaml:7")
    failure = FailureValue(
        "B", "last", node="recover", place="bring.yaml:5", beside=(beside,) * 500
    )
    links = page_data(recording(story={2: [(3, "FAILURE", "", failure)]}))["failures"][0]["links"]
    assert len(links) == 200
    assert {link["role"] for link in links[1:]} == {"after "}
    assert {link["at"] for link in links[1:]} == {4}


def test_the_board_has_keys_values_and_when(data):
    assert data["keys"] == ["found", "n", "@localization.quality"]
    writes = zip(*(data["writes"][name] for name in ("tick", "key", "value")), strict=True)
    found = [(tick, data["keys"][key], data["values"][value]) for tick, key, value in writes]
    assert found == [
        (0, "@localization.quality", "0.9"),
        (1, "found", "a can"),
        (8, "@localization.quality", "0.5"),
        (30, "n", "1"),
        (30, "found", "{x: 1.235, y: 0.5, yaw: 0}"),
    ]


def test_the_end_is_the_trees_and_not_that_of_coming_to_rest(recording):
    run = recording()
    ticks = (*run.ticks[:90], *(replace(tick, settling=True) for tick in run.ticks[90:]))
    data = page_data(replace(run, ticks=ticks))
    assert data["end"] == 89
    assert ["simulated", "4.45 s"] in data["about"]["facts"]


def test_keys_are_in_the_order_of_the_tree(recording):
    names = ("0.10/B/x", "0.2/A/x", "b", "0.2.1/C/a/b", "a")
    tick = TickRecord(0, 0.0, writes=tuple((name, 1) for name in names))
    keys = page_data(replace(recording(raw={}), ticks=(tick,)))["keys"]
    assert keys == ["a", "b", "0.2/A/x", "0.2.1/C/a/b", "0.10/B/x"]


def test_values_in_words():
    assert value_text({"a": (1, 2.0 / 3, None, True)}) == "{a: [1, 0.6667, nothing, true]}"
    assert value_text(MISSING) == "(no value)"
    assert value_text({"x": Opaque("a.B", "B(1)")}) == "{x: B(1)}"
    assert value_text((np.float32(0.5), np.arange(3), np.zeros((480, 640)))) == (
        "[0.5, [0, 1, 2], array of 480 x 640]"
    )
    assert value_text(math.inf) == "inf"
    assert len(value_text("x" * 10_000)) == WIDEST


def test_nodes_know_their_line_and_counts_come_from_the_report(data, recording):
    nodes = data["nodes"]
    assert nodes["file"] == [0] * 6
    assert nodes["line"] == [4, 4, 4, 5, 7, 8]
    assert nodes["above"] == [-1, 0, 1, 0, 3, 3]
    assert nodes["failures"] == [0, 1, 2, 3, 4, 5]
    counted = page_data(recording(report=None))["nodes"]
    assert counted["runs"] == [1, 1, 1, 1, 2, 1]
    assert counted["failures"] == [1, 0, 0, 1, 2, 0]


def test_a_frame_has_no_row_and_its_children_stand_in_its_place(recording):
    run = recording()
    roles = {1: Role.TREE, 2: Role.NAMED_STEPS, 3: Role.STEPS, 4: Role.STEPS}
    nodes = tuple(replace(node, role=roles.get(node.index, node.role)) for node in run.nodes)
    shown = page_data(replace(run, nodes=nodes))["nodes"]
    assert shown["row"] == [0, 1, 1, 3, 4, 5]
    assert shown["above"] == [-1, 0, 0, 0, 3, 3]


def test_a_row_says_what_the_node_is_for_the_one_above(recording):
    run = recording()
    plan = (("try: ", True), ("on LOST → ", False), ("on SLIPPED → ", True))
    nodes = tuple(replace(node, plan=plan if node.index == 3 else ()) for node in run.nodes)
    shown = page_data(replace(run, nodes=nodes))["nodes"]
    assert shown["prefix"] == ["", "", "", "", "try: ", "on SLIPPED → "]
    assert shown["again"] == [[], [], [], ["on LOST → try again"], [], []]


def test_labels_have_the_values_of_the_newest_start(recording):
    run = recording()
    newer = replace(run.ticks[40], labels=((4, "pick object can_1"),))
    data = page_data(replace(run, ticks=(*run.ticks[:40], newer, *run.ticks[41:])))
    labels = data["labels"]
    assert (labels["tick"][-1], labels["node"][-1]) == (40, 4)
    assert labels["texts"][labels["text"][4]] == "pick object $found"
    assert labels["texts"][labels["text"][-1]] == "pick object can_1"
    assert data["lanes"][1]["bars"][0]["words"].startswith("pick object can_1 (")


def test_a_leaf_that_is_skipped_while_it_runs_was_stopped(recording):
    story = {3: [(4, "RUNNING", "", None)], 5: [(4, "SKIPPED", "", None)]}
    bar = page_data(recording(story=story, ticks=10))["lanes"][0]["bars"][0]
    assert (bar["begin"], bar["end"], bar["status"]) == (3, 5, 0)
    assert bar["words"].endswith("was stopped")


def test_pictures_are_inside(data):
    (camera,) = data["cameras"]
    assert camera["name"] == "head"
    assert camera["times"] == [0.0, 1.0, 3.0]
    assert all(image.startswith("data:image/jpeg;base64,/9j/") for image in camera["images"])


def test_a_record_without_anything_has_a_page(recording):
    data = page_data(recording(nodes=(), ticks=0, story={}, files={}, report=None, raw={}))
    assert data["times"] == []
    assert data["floor"]["bounds"] is None
    assert data["lanes"] == data["failures"] == data["cameras"] == []
