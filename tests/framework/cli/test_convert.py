"""`momantu-bt convert`: directions, what is refused, and that nothing is half written."""

from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.tree.load import read_file

YAML = "momantu_bt: 1\nmain: Main\n\ntrees:\n  Main:\n    - open_door: {wide: true}  # first\n"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A tree of a node that is not installed."""
    path = tmp_path / "door.yaml"
    path.write_text(YAML, encoding="utf-8")
    return path


def test_to_the_terminal_in_the_other_spelling(
    tree: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["convert", str(tree)]) == 0
    shown = capsys.readouterr().out
    assert '<open_door wide="true"/> <!-- first -->' in shown
    assert 'BTCPP_format="4"' in shown


def test_there_and_back(tree: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    xml, back = tmp_path / "door.xml", tmp_path / "back.yml"
    assert main(["convert", str(tree), "-o", str(xml)]) == 0
    assert main(["convert", str(xml), "--output", str(back)]) == 0
    assert back.read_text(encoding="utf-8") == YAML
    assert capsys.readouterr().out == f"wrote {xml}\nwrote {back}\n"


def test_the_same_spelling_puts_a_file_in_order(
    tree: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tree.write_text(YAML.replace("{wide: true}", "{ wide:   true }"), encoding="utf-8")
    assert main(["convert", str(tree), "--to", "yaml"]) == 0
    assert capsys.readouterr().out == YAML


def test_a_file_is_overwritten_only_by_force(
    tree: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    there = tmp_path / "there.xml"
    there.write_text("mine", encoding="utf-8")
    assert main(["convert", str(tree), "-o", str(there)]) == 2
    assert "--force" in capsys.readouterr().err
    assert there.read_text(encoding="utf-8") == "mine"
    assert main(["convert", str(tree), "-o", str(there), "--force"]) == 0
    assert "<root" in there.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "output", "message"),
    [
        ("momantu_bt: 1\ntrees:\n  Main:\n    - retry: 3\n", "new.xml", "no node"),
        (YAML, "new.txt", "say --to yaml or --to xml"),
        (YAML, "nowhere/new.xml", "there is no folder"),
        ("momantu_bt: 1\ntrees: {Main: {open: {a: &a [*a]}}}\n", "new.xml", "contains it"),
    ],
)
def test_what_is_refused(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    text: str,
    output: str,
    message: str,
) -> None:
    source = tmp_path / "source.yaml"
    source.write_text(text, encoding="utf-8")
    assert main(["convert", str(source), "-o", str(tmp_path / output)]) == 2
    assert message in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["source.yaml"]


def test_what_one_spelling_cannot_say_is_refused_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "groot.xml"
    text = '<root BTCPP_format="4">\n<BehaviorTree ID="M"><Go/></BehaviorTree>\n<Palette/></root>'
    source.write_text(text, encoding="utf-8")
    assert main(["convert", str(source)]) == 2
    shown = capsys.readouterr().err
    assert f"{source}:3:2: error: a tree file has no <Palette>" in shown


def test_nesting_that_yaml_does_not_allow_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "deep.xml"
    inside = "<Sequence>" * 70 + "<AlwaysSuccess/>" + "</Sequence>" * 70
    text = f'<root BTCPP_format="4"><BehaviorTree ID="M">{inside}</BehaviorTree></root>'
    source.write_text(text, encoding="utf-8")
    assert main(["convert", str(source)]) == 2
    assert "levels deep" in capsys.readouterr().err


def test_included_files_stay_what_they_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "pyproject.toml").touch()
    (tmp_path / "other.yaml").write_text(
        "momantu_bt: 1\ntrees: {Other: [succeed]}\n", encoding="utf-8"
    )
    source, target = tmp_path / "main.yaml", tmp_path / "made" / "main.xml"
    source.write_text(
        "momantu_bt: 1\ninclude: [other.yaml]\nmain: Main\ntrees: {Main: [Other]}\n",
        encoding="utf-8",
    )
    target.parent.mkdir()
    assert main(["convert", str(source), "-o", str(target)]) == 0
    text = target.read_text(encoding="utf-8")
    assert '<include path="../other.yaml"/>' in text
    assert '<SubTree ID="Other"/>' in text
    assert 'BehaviorTree ID="Other"' not in text
    document, problems = read_file(target)
    assert problems.sorted() == []
    assert sorted(document.trees) == ["Main", "Other"]
