"""The lines of a tree that fit: never more than there is room for, and those that matter."""

from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.folding import fitted
from momantu_bt.world import TreeLine

STATUSES = ("IDLE", "RUNNING", "SUCCESS", "FAILURE", "SKIPPED")


@st.composite
def trees(draw):
    """Lines in the order of a tree: each at most one deeper than the one before."""
    lines, depth = [], -1
    for number in range(draw(st.integers(0, 50))):
        depth = draw(st.integers(min(1, depth + 1), depth + 1))
        lines.append(TreeLine(depth, str(number), draw(st.sampled_from(STATUSES))))
    return lines


@given(trees(), st.integers(1, 40))
def test_it_fits_and_keeps_the_order_and_what_runs(lines, room):
    part = fitted(lines, room)
    assert len(part) <= room
    kept = [line for line in part if not line.text.startswith("…")]
    assert [int(line.text) for line in kept] == sorted(int(line.text) for line in kept)
    assert all(line in lines for line in kept)
    running = [line for line in lines if line.status == "RUNNING"]
    if running:
        assert max(running, key=lambda line: line.depth) in kept


@given(trees())
def test_with_room_for_all_nothing_is_left_out(lines):
    assert fitted(lines, len(lines)) == lines


@given(trees(), st.integers(3, 40))
def test_every_line_is_there_or_counted(lines, room):
    part = fitted(lines, room)
    counted = sum(
        int(word.split()[0])
        for line in part
        if line.text.startswith("… ")
        for word in line.text[2:].split(", ")
    )
    kept = sum(not line.text.startswith("…") for line in part)
    assert kept + counted == len(lines) or len(lines) <= room or not counted


def test_what_is_near_the_running_node_stays():
    far = [TreeLine(1, f"far {i}", "IDLE") for i in range(20)]
    lines = [
        TreeLine(0, "root", "RUNNING"),
        TreeLine(1, "before", "SUCCESS"),
        TreeLine(1, "work", "RUNNING"),
        TreeLine(2, "tried", "FAILURE"),
        TreeLine(2, "now", "RUNNING"),
        TreeLine(2, "next", "IDLE"),
        *far,
    ]
    shown = [line.text for line in fitted(lines, 7)]
    assert shown == ["root", "before", "work", "tried", "now", "next", "… 20 not begun"]
