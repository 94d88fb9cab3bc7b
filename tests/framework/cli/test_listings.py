"""What check, show, skills, worlds and robots print, against what they print it about."""

import json
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from momantu_bt import plugins
from momantu_bt.cli import main
from momantu_bt.plugins import PluginError
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.values.types import label
from momantu_bt.world_plugins import WORLDS

Out = pytest.CaptureFixture[str]
TREE = "momantu_bt: 1\nvalues: {n: 66 mm}\ntrees:\n  Main: [{wait: 1 s, timeout: 3 s}]\n"


def printed(capsys: Out, *arguments: str) -> str:
    """What a command line that succeeds prints."""
    assert main(arguments) == 0
    said = capsys.readouterr()
    assert said.err == ""
    return said.out


def as_json(capsys: Out, *arguments: str) -> Any:
    """What it prints with `--json`."""
    return json.loads(printed(capsys, *arguments, "--json"))


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A tree that runs anywhere."""
    path = tmp_path / "t.yaml"
    path.write_text(TREE, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", SKILLS)
def test_a_skill_is_shown_whole(capsys: Out, name: str) -> None:
    skill = SKILLS.load(name)
    about = as_json(capsys, "skills", "show", name)
    text = printed(capsys, "skills", "show", name)
    assert {port["name"] for port in about["ports"]} == set(skill.ports)
    for port in about["ports"]:
        known = skill.ports[port["name"]]
        assert (port["direction"], port["type"]) == (known.direction, label(known.type))
        assert port["required"] is known.required
        assert f"  {port['name']}: {port['type']}" in text
        assert f" in {known.unit}" in text or known.unit is None
    assert about["failures"] == dict(skill.failures)
    assert all(f"  {code}: {said}" in text for code, said in skill.failures.items())
    assert set(about["uses"]) == set(skill.uses)


def test_lists_name_everything_installed(capsys: Out) -> None:
    for kind, group in (
        ("skills", SKILLS),
        ("worlds", WORLDS),
        ("robots", ROBOTS),
    ):
        rows = as_json(capsys, kind)
        assert [row["name"] for row in rows] == list(group)
        assert all(row["about"] for row in rows)
        lines = printed(capsys, kind).splitlines()
        assert [line.split()[0] for line in lines] == [row["name"] for row in rows]


@pytest.mark.parametrize("name", WORLDS)
def test_a_world_is_shown_whole(capsys: Out, name: str) -> None:
    about = as_json(capsys, "worlds", "show", name)
    text = printed(capsys, "worlds", "show", name)
    site = WORLDS.load(name).site()
    assert set(about["surfaces"]) == set(site.surfaces)
    assert set(about["places"]) == set(site.places)
    assert about["default_robot"] in ROBOTS
    assert all(f"  {each}: " in text for each in (*site.surfaces, *site.places))


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_is_shown_whole(capsys: Out, name: str) -> None:
    about = as_json(capsys, "robots", "show", name)
    text = printed(capsys, "robots", "show", name)
    assert {"home", "ready", "carry", "look_around"} <= set(about["named_poses"])
    for kind in ("actuators", "sensors"):
        assert about[kind]
        assert all(f"  {each}: " in text for each in about[kind])


def test_one_broken_plug_in_does_not_hide_the_others(
    capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = SKILLS.load

    def load(name: str) -> Any:
        if name == "pick":
            raise PluginError("its library is missing")
        return whole(name)

    monkeypatch.setattr(SKILLS, "load", load)
    assert main(["skills", "--json"]) == 1
    about = {row["name"]: row["about"] for row in json.loads(capsys.readouterr().out)}
    assert about["pick"] == "broken: its library is missing"
    assert list(about) == list(SKILLS)


@pytest.mark.parametrize("group", [SKILLS, WORLDS, ROBOTS])
def test_a_list_with_a_broken_entry_says_so_and_ends_with_1(
    capsys: Out, monkeypatch: pytest.MonkeyPatch, group: plugins.Group[Any]
) -> None:
    def load(name: str) -> Any:
        raise OSError("no disk\nand no tape")

    monkeypatch.setattr(group, "load", load)
    verb = f"{group.what}s"
    for arguments in ([verb], [verb, "list"], [verb, "list", "--json"]):
        assert main(arguments) == 1
        said = capsys.readouterr()
        assert "broken: OSError: no disk and no tape" in said.out
        assert said.out.count("no disk") == len(group)


def test_a_broken_skill_has_no_page_and_the_others_have(
    capsys: Out, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    whole = SKILLS.load

    def load(name: str) -> Any:
        if name == "pick":
            raise PluginError("the skill 'pick' cannot be loaded")
        return whole(name)

    monkeypatch.setattr(SKILLS, "load", load)
    assert main(["skills", "pages", str(tmp_path)]) == 1
    assert "left out: the skill 'pick' cannot be loaded" in capsys.readouterr().err
    written = {path.stem for path in tmp_path.glob("*.md")}
    assert {"index", *SKILLS} - written == {"pick"}


def test_a_list_of_nothing_says_so(capsys: Out, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ROBOTS, "installed", dict)
    assert main(["robots"]) == 0
    said = capsys.readouterr()
    assert (said.out, said.err) == ("", "none is installed\n")
    assert main(["robots", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == []


@pytest.mark.parametrize("name", sorted(bundled()))
def test_a_bundled_tree_is_shown_with_all_its_trees_and_values(capsys: Out, name: str) -> None:
    from momantu_bt.tree.load import load

    document = load(name).document
    lines = printed(capsys, "show", name).splitlines()
    where = "" if document.world is None else f" in {document.world}"
    assert lines[0].endswith(f": {document.main}{where}")
    assert [line.split()[0] for line in lines[1 : len(document.values) + 1]] == [*document.values]
    heads = [line.split()[0] for line in lines[1:] if line and not line.startswith(" ")]
    assert heads == [document.main, *(each for each in document.trees if each != document.main)]


@pytest.mark.parametrize(
    ("arguments", "where"),
    [([], ""), (["--world", "none"], ""), (["--world", "four_rooms"], " in four_rooms")],
)
def test_show_names_the_world_it_was_given(
    capsys: Out, tree: Path, arguments: list[str], where: str
) -> None:
    lines = printed(capsys, "show", str(tree), *arguments).splitlines()
    assert lines == [
        f"{tree}: Main{where}",
        "  n = 66 mm",
        "",
        "Main",
        "  sequence",
        "    wait 1 s  (at most 3 s)",
    ]


def test_show_without_the_files_own_world(capsys: Out, tree: Path) -> None:
    tree.write_text("world: four_rooms\n" + TREE, encoding="utf-8")
    assert printed(capsys, "show", str(tree)).startswith(f"{tree}: Main in four_rooms\n")
    assert printed(capsys, "show", str(tree), "--world", "none").startswith(f"{tree}: Main\n")


def test_checking_several_trees_tells_of_each(capsys: Out, tree: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_bytes(TREE.replace("wait", "wat").replace("\n", "\r\n").encode())
    assert main(["check", str(bad), str(tree), "x" * 5000]) == 2
    said = capsys.readouterr()
    assert said.out == f"{tree}: no errors in 1 tree with 3 nodes\n"
    first, line, caret, *_ = said.err.splitlines()
    assert first.startswith(f"{bad}:4:11: error: no node is called 'wat'")
    assert caret.index("^^^") == line.index("wat")
    assert "internal error" not in said.err


def test_the_json_of_a_problem_is_the_problem(capsys: Out, tree: Path) -> None:
    tree.write_text(TREE.replace("1 s", "日 m"), encoding="utf-8")
    assert main(["check", "--json", str(tree)]) == 2
    (problem,) = json.loads(capsys.readouterr().out)["trees"][0]["problems"]
    assert problem["code"] == "wrong-value"
    assert "日 m" in problem["message"]
    assert (problem["severity"], problem["file"]) == ("error", str(tree))
    assert (problem["line"], problem["column"], problem["length"]) == (4, 17, 3)
    capsys.readouterr()
    assert main(problem["help"].split()[1:]) == 0
    assert "wrong-value" in capsys.readouterr().out


def test_a_warning_is_told_and_does_not_fail(capsys: Out, tree: Path) -> None:
    tree.write_text(
        TREE.replace("trees:", "main: Main\ntrees:\n  Spare: {wait: 1}"), encoding="utf-8"
    )
    assert main(["check", str(tree)]) == 0
    said = capsys.readouterr()
    assert "[unused-tree]" in said.err
    assert "\n2 warnings;" in said.err, "and nothing reads the value `n`"
    assert "no errors" in said.out


def test_the_schema_is_printed_or_written(capsys: Out, tmp_path: Path) -> None:
    shown = json.loads(printed(capsys, "skills", "schema"))
    path = tmp_path / "schema.json"
    assert str(path) in printed(capsys, "skills", "schema", "-o", str(path))
    assert json.loads(path.read_text(encoding="utf-8")) == shown


def test_the_schema_of_a_world_and_a_robot(capsys: Out) -> None:
    asked = ("skills", "schema", "--world", "four_rooms", "--robot", "fetch")
    said = printed(capsys, *asked)
    assert all(f'"{name}"' in said for name in ("table_a", "corridor", "look_around"))


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (("--world", "fuor_rooms"), "did you mean 'four_rooms'?"),
        (("--robot", "fecth"), "did you mean 'fetch'?"),
        (("-o", "no_folder/schema.json"), "there is no folder no_folder"),
    ],
)
def test_a_schema_that_cannot_be_made(capsys: Out, asked: tuple[str, ...], message: str) -> None:
    assert main(["skills", "schema", *asked]) == 2
    assert message in capsys.readouterr().err


def test_a_broken_plugin_is_left_out_of_the_schema(
    capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = SKILLS.load

    def load(name: str) -> Any:
        if name == "pick":
            raise PluginError("the skill 'pick' cannot be loaded")
        return whole(name)

    monkeypatch.setattr(SKILLS, "load", load)
    assert main(["skills", "schema"]) == 0
    said = capsys.readouterr()
    assert "left out: the skill 'pick'" in said.err
    assert "pick" not in json.loads(said.out)["$defs"]["mapping"]["properties"]


def test_skills_are_tested_by_name(capsys: Out) -> None:
    said = printed(capsys, "skills", "test", "look", "reset_pose", "--halts", "1")
    assert said.split() == ["ok", "look", "ok", "reset_pose"]
    told = as_json(capsys, "skills", "test", "look", "--halts", "1")
    assert told == {"ok": True, "skills": {"look": []}}


def test_a_skill_that_breaks_a_promise_does_not_pass(
    capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry = EntryPoint("odd", "momantu_skills.check:Odd", SKILLS.name)
    monkeypatch.setattr(plugins, "entry_points", lambda group: [entry])
    assert main(["skills", "test"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("WRONG odd\n")
    assert "error: the skill 'odd'" in said
    assert said.endswith("[broken]\n")
    assert main(["skills", "test", "od"]) == 2
    assert "did you mean 'odd'?" in capsys.readouterr().err


def test_a_robot_whose_function_raises_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: Out
) -> None:
    def torn() -> None:
        raise OSError("the disk is gone")

    monkeypatch.setattr(ROBOTS, "load", lambda name: torn)
    assert main(["robots", "show", "hall"]) == 2
    said = capsys.readouterr().err
    assert said == "momantu-bt: the robot 'hall' cannot be read: OSError: the disk is gone\n"
