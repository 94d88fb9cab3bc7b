"""`momantu-bt show`: words, pictures, differences, and where they go."""

from pathlib import Path

import pytest
from lxml import etree

from momantu_bt.cli import main

Out = pytest.CaptureFixture[str]
TREE = """momantu_bt: 1
world: four_rooms
values: {place: corridor}
trees:
  Main:
    - navigate: {in_front_of: $place}
      retry: 3
    - detect_object: {object: {category: can}, on: table_a, found: $seen}
    - pick: {object: $seen}
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A tree with a wire."""
    path = tmp_path / "t.yaml"
    path.write_text(TREE, encoding="utf-8")
    return path


def test_words_end_with_the_wires(capsys: Out, tree: Path) -> None:
    assert main(["show", str(tree)]) == 0
    assert capsys.readouterr().out.splitlines()[3:] == [
        "Main",
        "  sequence",
        "    navigate in_front_of $place  (3 tries)",
        "    detect_object object {category: can}, on table_a, found $seen",
        "    pick object $seen",
        "  wires, with lines of the file",
        "    $place  from values             to navigate (6)",
        "    $seen   from detect_object (8)  to pick (9)",
    ]
    assert main(["show", str(tree), "--no-wires"]) == 0
    assert "  wires, with" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("option", "start"), [("--svg", "<svg "), ("--dot", "digraph"), ("--mermaid", "flowchart TD")]
)
def test_pictures_go_to_the_output_or_a_file(
    capsys: Out, tree: Path, tmp_path: Path, option: str, start: str
) -> None:
    assert main(["show", str(tree), option]) == 0
    said = capsys.readouterr()
    assert said.out.startswith(start)
    assert "$seen" in said.out or "#36;seen" in said.out
    assert said.err == ""
    file = tmp_path / "picture"
    assert main(["show", str(tree), option, "-o", str(file)]) == 0
    assert file.read_text(encoding="utf-8") == said.out
    assert capsys.readouterr().out == ""


def test_the_svg_of_a_bundled_tree_can_be_read(capsys: Out) -> None:
    assert main(["show", "bring_object", "--svg"]) == 0
    assert etree.fromstring(capsys.readouterr().out).get("width") is not None


def test_the_difference_of_two_trees_and_its_exit_code(
    capsys: Out, tree: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(TREE.replace("retry: 3", "retry: 5"), encoding="utf-8")
    assert main(["show", str(tree), str(tree)]) == 0
    assert capsys.readouterr().out == ""
    assert main(["show", str(tree), str(other)]) == 1
    assert capsys.readouterr().out.splitlines() == [
        "  Main",
        "    sequence",
        "~     navigate in_front_of $place  (5 tries)  [retry 3 -> 5]",
        "      detect_object object {category: can}, on table_a, found $seen",
        "      pick object $seen",
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--svg", "--dot"], "choose one of --svg and --dot"),
        (["bring_object", "--svg"], "leave --svg out"),
        (["-o", "no/such/folder/x"], "cannot be written"),
        (["nowhere.yaml"], "there is no file nowhere.yaml"),
    ],
)
def test_what_cannot_be_done_is_said(
    capsys: Out, tree: Path, arguments: list[str], message: str
) -> None:
    assert main(["show", str(tree), *arguments]) == 2
    assert message in capsys.readouterr().err


def test_values_from_outside_are_shown(capsys: Out, tree: Path) -> None:
    assert main(["show", str(tree), "--set", "place=home"]) == 0
    assert "  place = home\n" in capsys.readouterr().out


def test_a_tree_with_errors_is_not_drawn(capsys: Out, tree: Path) -> None:
    tree.write_text(TREE.replace("retry: 3", "retry: often"), encoding="utf-8")
    assert main(["show", str(tree), "--svg"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "does not fit; expected int" in said.err
