"""Trees that come as a text or as a mapping: what they mean, and what is told of wrong ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import momantu_bt
from momantu_bt.cli import main
from momantu_bt.errors import InputError
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.tree.files.given_text import TreeText, tree_source
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.load import TreeError, TreeNotFound

YAML_TEXT = "momantu_bt: 1\ntrees: {Main: [{set: {key: $n, value: 3}}, {wait: 0.1 s}]}\n"
XML_TEXT = """<root BTCPP_format="4" main_tree_to_execute="Main"><BehaviorTree ID="Main">
<SetBlackboard output_key="n" value="3"/></BehaviorTree></root>"""
MAPPING = {
    "momantu_bt": 1,
    "trees": {"Main": [{"set": {"key": "$n", "value": 3}}, {"wait": 0.1}, "succeed"]},
}

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=3)
    | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=12,
)  # fmt: skip


@given(tree=st.dictionaries(st.text(max_size=8), PLAIN, min_size=1, max_size=4))
def test_the_text_of_a_mapping_reads_back_as_the_mapping(tree: dict[str, Any]) -> None:
    source = tree_source(tree)
    assert isinstance(source, TreeText)
    assert plain_value(compose(source.text, source.shown)) == tree


@pytest.mark.parametrize("tree", [YAML_TEXT, XML_TEXT, XML_TEXT.replace("\n", ""), MAPPING])
def test_a_text_and_a_mapping_run(tree: Any) -> None:
    report = momantu_bt.run(tree, world="none")
    assert report.status == "SUCCESS"
    assert report.blackboard["n"] in (3, "3")
    assert report.tree == "<tree>"


def test_a_path_is_a_file_and_a_name_a_bundled_tree(tmp_path: Path) -> None:
    file = tmp_path / "t.yaml"
    file.write_text(YAML_TEXT)
    for tree in (file, str(file)):
        assert momantu_bt.run(tree, world="none").tree == str(file)
    with pytest.raises(TreeNotFound, match="did you mean bring_object"):
        momantu_bt.run("bring_objekt")
    with pytest.raises(TreeNotFound):
        momantu_bt.run(Path("momantu_bt: 1\n"))


@pytest.mark.parametrize(
    ("tree", "kind", "said"),
    [
        (YAML_TEXT.replace("wait", "wiat"), TreeError, "did you mean wait?"),
        ({**MAPPING, "trees": {"Main": [{"wiat": 1}]}}, TreeError, "<tree>:4:7: error: no node"),
        ({**MAPPING, "values": {"x": object}}, InputError, "the tree['values']['x'] is type"),
        ({**MAPPING, "values": [float("inf")]}, InputError, "['values'][0] is inf; a tree holds"),
        ({1.5: 2}, InputError, "the key 1.5; expected a text or a whole number"),
        (7, InputError, "a bundled tree's name, a text or a mapping, not int"),
        ("{" + " " * 500_000, TreeError, "500001 bytes"),
    ],
)
def test_what_is_wrong_is_told(tree: Any, kind: type[Exception], said: str) -> None:
    with pytest.raises(kind) as error:
        momantu_bt.run(tree, world="none")
    assert said in str(error.value)


def test_a_mapping_that_contains_itself_is_refused() -> None:
    tree: dict[str, Any] = {}
    tree["a"] = [tree]
    with pytest.raises(InputError, match="contains itself"):
        tree_source(tree)


def test_a_text_includes_from_the_working_directory(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "more.yaml").write_text("momantu_bt: 1\ntrees: {Below: [{wait: 0.1 s}]}\n")
    monkeypatch.chdir(tmp_path)
    tree = {"momantu_bt": 1, "include": ["more.yaml"], "main": "Main", "trees": {"Main": ["Below"]}}
    assert momantu_bt.run(tree, world="none").status == "SUCCESS"


def test_the_record_of_a_text_is_ticked_again(tmp_path: Path, capsys) -> None:
    momantu_bt.run(MAPPING, world="none", record=tmp_path / "run")
    assert main(["replay", str(tmp_path / "run"), "--check"]) == 0, capsys.readouterr()
