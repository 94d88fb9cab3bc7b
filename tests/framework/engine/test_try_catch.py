"""TryCatch and RecoveryNode beside their tables: which failure they end with, and odd halts."""

from __future__ import annotations

from momantu_bt.engine.context import Remarked
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import IDLE
from momantu_bt.failure import INPUT_MISSING, Failure
from momantu_bt.nodes.recovery_node import RecoveryNode
from momantu_bt.nodes.try_catch import TryCatch


def test_the_failure_is_the_tried_childs_with_the_cleaners_beside_it(bench):
    node = bench.node(TryCatch, ["S", "F", "F"])
    assert bench.tick(node) == "F"
    assert node.failure.node == "leaf1"
    assert [beside.node for beside in node.failure.beside] == ["leaf2"]


def test_people_see_why_it_cleans_up(bench):
    node = bench.node(TryCatch, ["F", "RS"])
    bench.tick(node)
    assert node.note == "FAILED: cleaning up"
    assert bench.ticks(node) == "F"
    assert node.note == ""


def test_a_halt_cleans_up_once_and_may_be_repeated(bench):
    node = bench.node(TryCatch, ["R", "R"], catch_on_halt=True)
    bench.tick(node)
    node.reset()
    node.reset()
    assert [kid.halts for kid in node.kids] == [1, 1]
    assert [kid.given for kid in node.kids] == [1, 1]
    assert {each.state for each in (node, *node.kids)} == {IDLE}


def test_a_halt_while_it_cleans_up_does_not_begin_anew(bench):
    node = bench.node(TryCatch, ["F", "R"], catch_on_halt=True)
    bench.tick(node)
    node.reset()
    assert [kid.given for kid in node.kids] == [1, 1]


def test_a_halt_goes_through_though_nobody_knows_whether_to_clean_up(bench):
    remarks = []
    bench.context.events.subscribe(Remarked, lambda event: remarks.append(event.text))
    node = bench.node(TryCatch, ["R", "S"])

    def missing():
        raise Failure(INPUT_MISSING, "no value")

    node.inputs = Inputs({"catch_on_halt": missing})
    bench.tick(node)
    node.reset()
    assert (node.state, node.kids[0].halts, node.kids[1].given) == (IDLE, 1, 0)
    assert "no value" in remarks[0]


def test_a_recovery_that_fails_has_the_first_failure_as_its_cause(bench):
    node = bench.node(RecoveryNode, ["F", "F"], number_of_retries=3)
    assert bench.tick(node) == "F"
    assert [link.node for link in node.failure.chain()] == ["leaf1", "leaf0"]


def test_a_recovery_node_says_how_often_it_tried(bench):
    node = bench.node(RecoveryNode, ["F", "RS"], number_of_retries=1)
    assert bench.tick(node) == "R"
    assert node.note == "try 1, recovering from FAILED"
    assert bench.tick(node) == "F"
    assert (node.failure.tries, node.failure.most_tries) == (2, 2)
