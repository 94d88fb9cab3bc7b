"""`momantu-bt faults` and docs/faults.md."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.pages import as_parameters, as_table, as_text, as_words
from momantu_bt.faults.spec import parse_fault

PAGE = Path(__file__).parents[3] / "docs" / "faults.md"


def test_the_page_has_the_tables_as_they_are_now():
    page = PAGE.read_text(encoding="utf-8")
    for table in (as_table(), as_words(), as_parameters()):
        assert table in page, "run `momantu-bt faults --markdown` and put its tables into the page"


def test_every_fault_is_listed_and_shown(capsys):
    assert main(["faults"]) == main(["faults", "list"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == 2 * list(kinds())
    for name, kind in kinds().items():
        text = as_text(kind)
        assert text.startswith(f"{name}: {kind.doc}")
        assert all(f"  {port.name} (" in text for port in kind.parameters)


@pytest.mark.parametrize("name", sorted(kinds()))
def test_the_example_of_each_page_is_a_fault(name):
    example = as_text(kinds()[name]).rsplit("--fault ", 1)[1].strip('"')
    assert parse_fault(example).name == name


def test_json(capsys):
    assert main(["faults", "--json"]) == 0
    every = json.loads(capsys.readouterr().out)
    assert [about["name"] for about in every] == list(kinds())
    assert main(["faults", "show", "camera.shifted", "--json"]) == 0
    about = json.loads(capsys.readouterr().out)
    assert about["parameters"][0]["default"] == 0.015
    assert about["parameters"][1]["default"] == "inf"
    assert about["rows"] == [{"fault": "camera.shifted", "recoverable": True}]


def test_an_unknown_fault_is_explained(capsys):
    assert main(["faults", "show", "camera.ded"]) == 2
    assert "did you mean dead?" in capsys.readouterr().err


@pytest.mark.parametrize("fault", ["camera.ded", "camera.dead@nowhere", "camera.dead"])
def test_run_refuses_what_cannot_be(fault, tmp_path, capsys):
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\nmain: Main\ntrees: {Main: [{wait: 1 s}]}\n")
    assert main(["run", str(tree), "--fault", fault]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "camera" in err
    assert "Traceback" not in err
