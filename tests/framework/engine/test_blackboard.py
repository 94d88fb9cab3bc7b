"""Boards: scopes, wires, what is read-only, what can be changed behind one's back (nothing)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.blackboard import Board, Cell, ReadOnlyCell, rollback
from momantu_bt.engine.ports import outputs_of
from momantu_bt.failure import Failure
from momantu_bt.nodes.updates import WasEntryUpdated
from momantu_bt.skill import MISSING, Port
from momantu_bt.tree.model import Reference

VALUES = st.recursive(
    st.none() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


@given(value=VALUES)
def test_a_value_on_the_board_does_not_follow_the_one_it_came_from(value):
    board = Board([])
    kept = [value]
    board.set("key", kept)
    kept.append("later")
    assert len(board.get("key")) == 1


def test_arrays_are_copied_and_read_only():
    board, array = Board([]), np.zeros(2)
    board.set("key", array)
    array[0] = 1.0
    assert board.get("key")[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        board.get("key")[0] = 2.0


def test_an_output_of_a_node_takes_its_type_alone_and_makes_it_immutable():
    board = Board([])
    ports = {"sizes": Port("sizes", "out", tuple[float, ...], "")}
    outputs = outputs_of(ports, {"sizes": Reference("sizes")}, board)
    outputs["sizes"].write([1, 2.5])
    assert board.get("sizes") == (1.0, 2.5)
    with pytest.raises(Failure, match="port sizes got 'large' of type str, expected tuple"):
        outputs["sizes"].write("large")
    assert board.get("sizes") == (1.0, 2.5)


def test_a_subtree_sees_only_what_is_wired():
    journal = []
    outer = Board(journal)
    outer.set("a", 1)
    outer.set("b", 2)
    inner = Board(journal, outer, {"x": outer.cell("a")})
    assert inner.get("x") == 1
    assert not inner.has("a")
    inner.set("x", 5)
    inner.set("b", 6)
    assert (outer.get("a"), outer.get("b")) == (5, 2)


def test_autoremap_connects_everything_but_private_keys():
    journal = []
    outer = Board(journal)
    inner = Board(journal, outer, autoremap=True)
    inner.set("a", 1)
    inner.set("_private", 2)
    assert outer.get("a") == 1
    assert not outer.has("_private")


def test_at_means_the_root_from_any_depth():
    journal = []
    root = Board(journal)
    inner = Board(journal, Board(journal, root))
    inner.set("@key", 3)
    assert root.get("key") == 3
    assert inner.get("@key") == 3


def test_a_key_without_a_value_is_a_key_error():
    with pytest.raises(KeyError, match="nobody"):
        Board([]).get("nobody")


def test_a_published_key_is_asked_when_read_and_cannot_be_written():
    board, answers = Board([]), iter([1, 2])
    board.publish(ReadOnlyCell("service", lambda: next(answers)))
    assert (board.get("service"), board.get("service")) == (1, 2)
    with pytest.raises(Failure, match="read-only"):
        board.set("service", 3)
    assert board.values() == {}


def test_two_runs_share_nothing():
    first, second = Board([]), Board([])
    first.set("key", 1)
    assert not second.has("key")


@given(writes=st.lists(st.tuples(st.sampled_from("abc"), st.integers()), max_size=10))
def test_the_journal_can_be_rolled_back(writes):
    journal: list[tuple[Cell, object]] = []
    board = Board(journal)
    board.set("a", 0)
    before = board.values()
    journal.clear()
    for key, value in writes:
        board.set(key, value)
    first: dict[Cell, object] = {}
    for cell, held in journal:
        first.setdefault(cell, held)
    rollback(first.items())
    assert board.values() == before
    assert all(cell.value is MISSING or cell.name == "a" for cell in first)


def test_a_cell_counts_its_writes_also_of_equal_values():
    board = Board([])
    cell = board.cell("k")
    assert cell.writes == 0
    board.set("k", 1)
    board.set("k", 1)
    assert cell.writes == 2


def test_a_published_key_counts_as_written_when_another_value_is_found_there():
    values = ["a"]
    cell = ReadOnlyCell("robot", lambda: values[-1])
    assert [cell.writes, cell.writes] == [1, 1]
    values.append("b")
    assert [cell.writes, cell.writes] == [2, 2]


def test_a_node_that_watches_a_published_key_sees_each_new_value(bench):
    values = ["a"]
    cell = ReadOnlyCell("robot", lambda: values[-1])
    bench.board.publish(cell)
    node = bench.node(WasEntryUpdated, [], entry=Reference("robot"))
    assert [bench.tick(node), bench.tick(node)] == ["S", "F"]
    values.append("b")
    assert [bench.tick(node), bench.tick(node)] == ["S", "F"]
