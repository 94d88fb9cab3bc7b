"""The label of a node holds the values that its inputs had at its start."""

from __future__ import annotations

import pytest

from momantu_bt.engine.executor import Ticked
from momantu_bt.engine.label import ShowsValues
from momantu_bt.formats.places import Place
from momantu_bt.skill import In, Run, Skill
from momantu_bt.tree.model import Literal, Node, Reference


class Shown(ShowsValues):
    def __init__(self) -> None:
        ports = {"bay": Reference("bay"), "speed": Literal(0.5)}
        self.model = Node("Dock", Place("tree.yaml", 1, 1), ports)
        self.label = "before the start"


def test_a_label_is_of_the_newest_start() -> None:
    shown = Shown()
    assert shown.label == "before the start"
    shown.show_values({"bay": "east", "speed": 0.5})
    assert "east" in shown.label
    assert "0.5" in shown.label
    shown.show_values({"bay": "west", "speed": 0.5})
    shown.show_values({"bay": "north", "speed": 0.5})
    assert "north" in shown.label


def test_a_label_without_new_values_is_not_written_again() -> None:
    shown, bay = Shown(), "east"
    shown.show_values({"bay": bay})
    before = shown.label
    shown.show_values({"bay": bay})
    assert shown.label is before


@pytest.mark.parametrize(("before", "after"), [(2.0, 3.0), ("here", "there")])
def test_a_label_stays_when_the_key_changes_later(run_yaml, before, after) -> None:
    class Change(Skill):
        """Runs while its key changes."""

        value: object = In(doc="what it was")

        def run(self, robot) -> Run:
            yield "waits"
            yield "waits"

    found: list[str] = []

    def watch(run):
        leaf = next(node for node in run.built.nodes if node.name == "change")
        cell = run.built.board.cell("key")

        def ticked(event: Ticked) -> None:
            if leaf.state.name == "RUNNING":
                cell.write(after)
                found.append(leaf.label)

        run.context.events.subscribe(Ticked, ticked)
        return []

    tree = f"trees:\n  Main:\n    - set: {{key: $key, value: {before}}}\n    - change: $key\n"
    run_yaml(tree, Change, watch=watch)
    assert len(found) == 2
    assert found[0] == found[1]
    assert (f"{before:g}" if isinstance(before, float) else before) in found[0]
