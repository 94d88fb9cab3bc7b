"""Who writes what each key reads."""

from pathlib import Path

import pytest

from momantu_bt.drawing.wires import Wire, wire_lines, wires
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.load import load
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry


def ends(wire: Wire) -> tuple[list[str], list[str]]:
    """Who writes and who reads it."""
    return [end.said for end in wire.writers], [end.said for end in wire.readers]


TREE = """momantu_bt: 1
world: four_rooms
main: Patrol
values: {route: [corridor], endurance: 5 min, charged_at: 0 s}
trees:
  Patrol:
    for_each: {in: $route, as: $stop, child: {Visit: {place: $stop, side: $n}}}
    while: $endurance > 0
  Visit:
    inputs: {place: text}
    outputs: {side: int}
    sequence:
      - set: {key: $side, value: 1}
      - navigate: {in_front_of: $place, side: $side}
        skip_if: $@robot.stamp > $@charged_at
      - handle:
          try: {script: $@charged_at = $@robot.stamp}
          catch: {any: {fail: {code: LOST, message: $failure.message}}}
"""


@pytest.fixture
def patrol(tmp_path: Path, registry: Registry) -> Document:
    """A checked tree with every kind of wire."""
    path = tmp_path / "patrol.yaml"
    path.write_text(TREE, encoding="utf-8")
    return load(str(path), registry).document


def test_the_wires_of_a_tree_with_every_kind(patrol: Document, registry: Registry) -> None:
    found = {(wire.tree, wire.key): ends(wire) for wire in wires(patrol, registry)}
    assert found == {
        ("Patrol", "route"): (["values"], ["for_each"]),
        ("Patrol", "endurance"): (["values"], ["for_each"]),
        ("Patrol", "charged_at"): (["values", "script"], ["navigate"]),
        ("Patrol", "stop"): (["for_each"], ["Visit"]),
        ("Patrol", "n"): (["Visit"], []),
        ("Visit", "place"): (["the caller"], ["navigate"]),
        ("Visit", "side"): (["set"], ["the caller", "navigate"]),
        ("", "robot"): (["the robot"], ["navigate", "script"]),
        ("Visit", "failure"): (["handle"], ["fail"]),
    }


def test_every_key_that_is_read_in_a_bundled_tree_is_written(registry: Registry) -> None:
    for name in bundled():
        for wire in wires(load(name, registry).document, registry):
            assert wire.writers, (name, wire.key)


def test_lines_say_where_and_align(patrol: Document, registry: Registry) -> None:
    found = wires(patrol, registry)
    assert list(wire_lines(patrol, found, "Visit")) == [
        "$@charged_at  from values, script (17)  to navigate (14)",
        "$place        from the caller           to navigate (14)",
        "$side         from set (13)             to the caller, navigate (14)",
        "$@robot       from the robot            to navigate (14), script (17)",
        "$failure      from handle (16)          to fail (18)",
    ]


def test_an_output_nobody_reads_has_no_readers(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "t.yaml"
    path.write_text("momantu_bt: 1\ntrees:\n  Main: {set: {key: $n, value: 3}}\n", "utf-8")
    document = load(str(path), registry).document
    found = wires(document, registry)
    assert list(wire_lines(document, found, "Main")) == ["$n  from set (3)"]


def test_lines_of_an_included_tree_are_those_of_its_own_file(
    tmp_path: Path, registry: Registry
) -> None:
    part = (
        "momantu_bt: 1\ntrees:\n  Go:\n    inputs: {to: text}\n    navigate: {in_front_of: $to}\n"
    )
    (tmp_path / "part.yaml").write_text(part + "    skip_if: $@done\n", encoding="utf-8")
    path = tmp_path / "whole.yaml"
    path.write_text(
        "momantu_bt: 1\ninclude: [part.yaml]\nmain: Main\nvalues: {done: false}\n"
        "trees:\n  Main:\n    - script: $done = true\n    - Go: {to: corridor}\n",
        encoding="utf-8",
    )
    document = load(str(path), registry).document
    found = wires(document, registry)
    assert list(wire_lines(document, found, "Go")) == [
        "$@done  from values, script (whole.yaml:7)  to navigate (5)",
        "$to     from the caller                     to navigate (5)",
    ]
    assert list(wire_lines(document, found, "Main")) == [
        "$done  from values, script (7)  to navigate (part.yaml:5)"
    ]
