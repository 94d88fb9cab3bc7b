"""The file of faults beside a tree: what it changes, and what is said when it is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from momantu_bt.bench.episodes.parcel import Parcel
from momantu_bt.cli import main
from momantu_bt.cli.bench.setup import demands_of
from momantu_bt.faults.spec import parse_fault
from momantu_bt.faults.stage import plan
from momantu_bt.faults.tree_file import TreeFaults, tree_faults
from momantu_bt.tree.files.lookup import bundled, faults_file, tree_files
from momantu_bt.tree.load import load, read_file
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.substitution import Substitution

TREE = "momantu_bt: 1\nmain: Main\ntrees:\n  Main: [Rest, {wait: 2 s}]\n  Rest: {wait: 1 s}\n"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    file = tmp_path / "mine.yaml"
    file.write_text(TREE, encoding="utf-8")
    return file


def beside(tree: Path, text: str) -> Path:
    file = tree.with_name("mine.faults.yaml")
    file.write_text(f"momantu_bt: 1\n{text}", encoding="utf-8")
    return file


def begins(tree: Path, fault: str) -> str | None:
    document = load(str(tree), Registry()).document
    (planned,) = plan([parse_fault(fault)], document, {}, Substitution(), with_world=True)
    return planned.fault.phase


def test_a_tree_without_the_file_has_nothing_of_its_own(tree: Path) -> None:
    assert tree_faults(load(str(tree), Registry()).document) == TreeFaults()
    assert begins(tree, "camera.dead") == "start"


def test_a_fault_begins_when_the_file_says(tree: Path) -> None:
    beside(tree, "begins:\n  camera.dead: Rest/wait+500 ms\n")
    assert begins(tree, "camera.dead") == "Rest/wait+500 ms"
    assert begins(tree, "camera.dead@12 s") == "12 s"
    assert begins(tree, "laser.dead") == "start"


def test_rows_of_the_tree_are_run_where_the_pattern_fits(tree: Path) -> None:
    beside(tree, "rows:\n  - camera.dead@Rest:for=inf\n  - 'laser.dead@after-Rest'\n")
    assert {d.fault for d in demands_of(str(tree), [], "camera.dead")} == {
        "camera.dead",
        "camera.dead:for=inf",
        "camera.dead@Rest:for=inf",
    }
    (own,) = (d for d in demands_of(str(tree), [], "all") if "@Rest" in d.fault)
    assert not own.recoverable
    assert not [d for d in demands_of(str(tree), [], "skill.*") if "@" in d.fault]


@pytest.mark.parametrize(
    ("text", "marked", "said"),
    [
        ("begin: {}", "begin", "did you mean begins?"),
        ("begins: [camera.dead]", "[camera.dead]", "mapping of faults to phases"),
        ("begins: {camera.ded: Rest}", "camera.ded", "did you mean camera.dead?"),
        ("begins: {map.wrong: Rest}", "map.wrong", "it takes no phase"),
        ("begins: {camera.dead: [Rest]}", "[Rest]", "expected one phase"),
        ("begins: {camera.dead: Rset}", "Rset", "did you mean Rest?"),
        ("begins: {camera.dead: Rest#0}", "Rest#0", "whole number from 1"),
        ("rows: camera.dead", "camera.dead", "list of faults"),
        ("rows: [[camera.dead]]", "[camera.dead]", "a row is one fault"),
        ("rows: [camera.ded]", "ded", "did you mean dead?"),
        ("rows: ['camera.dead:fro=3']", "fro", "did you mean for?"),
        ("rows: [camera.dead@Nap]", "camera.dead@Nap", "no node that runs is called 'Nap'"),
    ],
)
def test_every_mistake_is_shown_at_its_place(
    tree: Path, capsys: pytest.CaptureFixture[str], text: str, marked: str, said: str
) -> None:
    file = beside(tree, text + "\n")
    with pytest.raises(TreeError) as caught:
        tree_faults(read_file(tree)[0])
    (problem,) = caught.value.problems
    place = problem.place
    assert (place.line, file.read_text().splitlines()[1][place.column - 1 :][: place.length]) == (
        2,
        marked,
    )
    assert said in f"{problem.message} {problem.hint}"
    assert main(["check", str(file)]) == main(["run", str(tree), "--fault", "camera.dead"]) == 2
    assert capsys.readouterr().err.count(f"{file}:2:{place.column}: error: ") == 2


@pytest.mark.parametrize("text", ["", "- begins", "momantu_bt: 2\nbegins: {}", "begins: {}"])
def test_what_is_not_such_a_file_is_refused(tree: Path, text: str) -> None:
    tree.with_name("mine.faults.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(TreeError):
        tree_faults(read_file(tree)[0])


def test_check_reads_it_against_the_tree_beside_it(
    tree: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = beside(tree, "begins: {camera.dead: Rest}\n")
    assert main(["check", str(file)]) == 0
    assert capsys.readouterr().out == f"{file}: no errors in 1 phase and 0 rows\n"
    tree.unlink()
    assert main(["check", str(file)]) == 2
    assert "faults in mine.yaml, which is not beside it" in capsys.readouterr().err


def test_the_listing_of_a_tree_says_when_its_faults_begin(
    tree: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    beside(tree, "begins: {camera.dead: Rest}\nrows: [laser.dead@after-Rest]\n")
    assert main(["faults", "--tree", str(tree), "--json"]) == 0
    told = {row["fault"]: row for row in json.loads(capsys.readouterr().out)}
    assert told["camera.dead:for=inf"]["begins"] == "Rest"
    assert told["laser.dead@after-Rest"]["begins"] == "after-Rest"
    assert told["skill.hang"]["begins"] is None
    assert "runs no skill" in told["skill.hang"]["why"]
    assert main(["faults", "list", "--tree", str(tree)]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["camera.dead:for=inf", "Rest", "no", "5", "s", "SENSOR_DEAD"] in lines


def test_the_schema_accepts_what_is_right_and_refuses_what_is_not(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["faults", "schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    accepts = Draft202012Validator(schema).is_valid
    yaml = YAML(typ="safe", pure=True)
    for name, file in bundled().items():
        beside = faults_file(file)
        assert not beside.exists() or accepts(yaml.load(beside.read_text())), name
    assert accepts({"momantu_bt": 1, "rows": ["camera.dead@12 s"]})
    assert not accepts({"begins": {}})
    assert not accepts({"momantu_bt": 1, "begins": {"camera.ded": "start"}})
    assert not accepts({"momantu_bt": 1, "begins": {"map.wrong": "start"}})


def test_it_is_no_tree_and_travels_with_its_tree(tree: Path) -> None:
    file = beside(tree, "begins: {camera.dead: Rest}\n")
    assert tree_files(tree.parent) == [tree]
    assert not [name for name in bundled() if "faults" in name]
    assert Parcel.of(str(tree)).texts[file.name] == file.read_text()
