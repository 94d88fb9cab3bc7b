"""Who writes what each key reads."""

from pathlib import Path

from momantu_bt.drawing.wires import Wire, wire_lines, wires
from momantu_bt.tree.load import load
from momantu_bt.tree.lookup import bundled
from momantu_bt.tree.registry import Registry


def ends(wire: Wire) -> tuple[list[str], list[str]]:
    """Who writes and who reads it."""
    return [end.said for end in wire.writers], [end.said for end in wire.readers]


def test_the_wires_of_a_tree_with_everything(registry: Registry) -> None:
    document = load("examples/patrol", registry).document
    found = {(wire.tree, wire.key): ends(wire) for wire in wires(document, registry)}
    assert found["Patrol", "stop"] == (["for_each"], ["Visit"])
    assert found["Patrol", "charged_at"] == (["values", "script"], ["condition"])
    assert found["Visit", "place"] == (["the caller"], ["navigate"])
    assert found["", "robot"] == (["the robot"], ["condition", "script"])
    assert found["Patrol", "endurance"] == (["values"], ["condition", "fail"])


def test_a_failure_is_written_by_the_node_that_caught_it(registry: Registry) -> None:
    document = load("examples/escalating_pick", registry).document
    found = {wire.tree: ends(wire) for wire in wires(document, registry) if wire.key == "failure"}
    assert found == {"PickUp": (["handle"], ["fail"]), "Grasp": (["handle"], ["fail"])}


def test_every_key_that_is_read_in_a_bundled_tree_is_written(registry: Registry) -> None:
    for name in bundled():
        for wire in wires(load(name, registry).document, registry):
            assert wire.writers, (name, wire.key)


def test_lines_say_where_and_align(registry: Registry) -> None:
    document = load("examples/patrol", registry).document
    lines = list(wire_lines(document, wires(document, registry), "Charge"))
    assert lines == [
        "$@charging    from values               to wait (41)",
        "$@charged_at  from values, script (42)  to condition (31)",
        "$@robot       from the robot            to condition (31), script (42)",
    ]


def test_an_output_nobody_reads_has_no_readers(tmp_path: Path, registry: Registry) -> None:
    path = tmp_path / "t.yaml"
    path.write_text("momantu_bt: 1\ntrees:\n  Main: {set: {key: $n, value: 3}}\n", "utf-8")
    document = load(str(path), registry).document
    found = wires(document, registry)
    assert list(wire_lines(document, found, "Main")) == ["$n  from set (3)"]
