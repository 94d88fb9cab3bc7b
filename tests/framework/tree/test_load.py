"""Finding, reading and checking files: names, near misses, and values from outside."""

from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.descriptions.reading import DescriptionError, KeyProblem
from momantu_bt.formats.places import Place
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.lookup import bundled, find
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.load import TreeError, TreeNotFound, load, read_values
from momantu_bt.tree.model import FIRST_INPUT, Literal
from momantu_bt.tree.registry import Registry
from momantu_bt.world import WorldError

GOOD = "momantu_bt: 1\nworld: rooms\nvalues: {to: door}\ntrees:\n  Main: [navigate: $to]\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with one good tree, `fetch_it.yaml`; it is the working folder."""
    (tmp_path / "fetch_it.yaml").write_text(GOOD, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_file_by_path(folder: Path, registry: Registry) -> None:
    checked = load("fetch_it.yaml", registry)
    assert checked.document.file == "fetch_it.yaml"
    assert checked.document.trees["Main"].root.children[0].ports.keys() == {"in_front_of"}
    assert checked.problems == []


def test_bundled_trees_by_name() -> None:
    assert {"bring_object", "bring_object_plain"} <= bundled().keys()
    assert not [name for name in bundled() if name.startswith("values/")]
    assert find("bring_object").name == "bring_object.yaml"
    assert find("examples/patrol").parts[-2:] == ("examples", "patrol.yaml")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("fetchit.yaml", "did you mean fetch_it.yaml?"),
        ("bring_object.yml", "did you mean the bundled tree bring_object?"),
        ("quite_other.yaml", "tree files there: fetch_it.yaml"),
        ("no/such.yaml", "there is no folder no"),
        ("bring_objct", "did you mean bring_object?"),
        ("zzz", "bundled trees: bring_object"),
        ("patrol", "no tree is called 'patrol'; did you mean examples/patrol?"),
        ("exmples/patrl", "did you mean examples/patrol?"),
        ("patrol.yaml", "did you mean the bundled tree examples/patrol?"),
        (".", "is a folder; tree files in it: fetch_it.yaml"),
    ],
)
def test_a_near_miss_is_named(folder: Path, name: str, message: str) -> None:
    with pytest.raises(TreeNotFound) as caught:
        load(name, Registry())
    assert message in str(caught.value)


def test_a_file_that_is_not_utf8(folder: Path) -> None:
    (folder / "bad.yaml").write_bytes(b"momantu_bt: 1\nmain: \xff\n")
    with pytest.raises(TreeError, match="bad.yaml:2:7: error: the file is not UTF-8"):
        load("bad.yaml", Registry())


def test_errors_keep_a_tree_from_loading(folder: Path, registry: Registry) -> None:
    (folder / "bad.yaml").write_text(GOOD.replace("navigate", "navigat"), encoding="utf-8")
    with pytest.raises(TreeError) as caught:
        load("bad.yaml", registry)
    assert "unknown-node" in [problem.code for problem in caught.value.problems]
    assert "navigat" in caught.value.source["bad.yaml"]


def test_values_from_outside_replace_the_files_own_and_are_checked(
    folder: Path, registry: Registry
) -> None:
    checked = load("fetch_it.yaml", registry, values={"to": "table_b"})
    assert checked.document.values == {"to": Literal("table_b")}
    with pytest.raises(TreeError, match="has no place 'nowhere'"):
        load("fetch_it.yaml", registry, values={"to": "nowhere"})


def test_a_given_value_that_nothing_reads_is_an_error(folder: Path, registry: Registry) -> None:
    with pytest.raises(TreeError, match="the tree has no value 'too'") as caught:
        load("fetch_it.yaml", registry, values={"too": "table_b"})
    assert "did you mean to?" in caught.value.problems[0].hint


def test_a_given_value_may_fill_a_key_that_the_file_leaves_open(
    folder: Path, registry: Registry
) -> None:
    (folder / "open.yaml").write_text(GOOD.replace("values: {to: door}\n", ""), encoding="utf-8")
    checked = load("open.yaml", registry, values={"to": "table_b"})
    assert checked.document.values == {"to": Literal("table_b")}


def test_another_world_or_robot_by_argument(folder: Path, registry: Registry) -> None:
    load("fetch_it.yaml", registry, world="none", values={"to": "anywhere"})
    with pytest.raises(TreeError, match="no world is called 'moon'"):
        load("fetch_it.yaml", registry, world="moon")
    with pytest.raises(TreeError, match="no robot is called 'r2'"):
        load("fetch_it.yaml", registry, robot="r2")


def test_what_the_command_line_names_is_told_there(folder: Path, registry: Registry) -> None:
    with pytest.raises(TreeError) as error:
        load("fetch_it.yaml", registry, world="moon", robot="r2")
    told = [(p.code, str(p.place), p.place.length) for p in error.value.problems]
    assert told == [("unknown-robot", "--robot:1:1", 2), ("unknown-world", "--world:1:1", 4)]
    assert error.value.source["--world"] == "moon"


def test_a_wrong_description_is_told_in_its_own_lines(folder: Path, registry: Registry) -> None:
    file, text = folder / "w.yaml", "momantu_world: 1\nname: 7\nrooms: many\n"

    class Wrong:
        default_robot = "toy"

        def site(self) -> None:
            found = [
                KeyProblem("", "expected rooms", Place(str(file), 3, 8)),
                KeyProblem("", "expected a name", Place(str(file), 2, 7)),
            ]
            raise DescriptionError(file, text, found)

    wrong = Registry(registry.skills, {"rooms": Wrong()}, registry.robots)  # type: ignore
    with pytest.raises(TreeError) as error:
        load("fetch_it.yaml", wrong)
    told = [(p.code, str(p.place), p.message) for p in error.value.problems]
    assert told == [
        ("broken-world", f"{file}:2:7", "expected a name"),
        ("broken-world", f"{file}:3:8", "expected rooms"),
    ]
    assert error.value.source[str(file)] == text


def test_a_world_that_cannot_be_read_is_one_problem(folder: Path, registry: Registry) -> None:
    class Broken:
        default_robot = "toy"

        def site(self) -> None:
            raise RuntimeError("no floor plan")

    broken = Registry(registry.skills, {"rooms": Broken()}, registry.robots)  # type: ignore
    with pytest.raises(TreeError, match="cannot be read: RuntimeError: no floor plan"):
        load("fetch_it.yaml", broken)


def test_a_robot_whose_files_are_missing_is_a_warning(folder: Path, registry: Registry) -> None:
    def missing() -> None:
        raise WorldError("the extra [worlds] is not installed")

    bare = Registry(registry.skills, registry.worlds, {"toy": missing})
    notes = load("fetch_it.yaml", bare).problems
    assert [note.code for note in notes] == ["robot-not-installed"]


def test_a_file_of_values(folder: Path) -> None:
    (folder / "v.yaml").write_text("to: door\nn: 3\nd: 2 cm\n", encoding="utf-8")
    assert read_values(folder / "v.yaml") == {"to": "door", "n": 3, "d": "2 cm"}
    (folder / "w.yaml").write_text("[1]", encoding="utf-8")
    with pytest.raises(TreeError, match="is a mapping"):
        read_values(folder / "w.yaml")
    with pytest.raises(TreeNotFound, match="cannot be read"):
        read_values(folder / "x.yaml")


def test_a_document_stays_as_it_was_read(registry: Registry) -> None:
    document, problems = read(GOOD, "tree.yaml")
    checked = check(document, registry, reading=problems)
    assert checked.problems == []
    *_, before = document.trees["Main"].root.walk()
    *_, after = checked.document.trees["Main"].root.walk()
    assert list(before.ports) == [FIRST_INPUT]
    assert FIRST_INPUT not in after.ports
    assert list(after.ports.values()) == list(before.ports.values())


def test_the_error_says_in_python_what_the_command_line_prints(tmp_path: Path, capsys) -> None:
    file = tmp_path / "t.yaml"
    file.write_text("momantu_bt: 1\ntrees:\n  Main: [{wiat: 1 s}, {succed: }]\n")
    with pytest.raises(TreeError) as error:
        load(str(file))
    assert main(["check", str(file)]) == 2
    assert capsys.readouterr().err.strip() == str(error.value)
    assert "did you mean wait?" in str(error.value)
    assert "2 errors" in str(error.value)
