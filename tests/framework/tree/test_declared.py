"""Nodes and trees that stand elsewhere: declared by models, in further files, or unknown."""

import json
from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.formats.problems import Severity

Out = pytest.CaptureFixture[str]

MODEL = """<TreeNodesModel>
  <Action ID="FollowWall">
    <input_port name="side" type="std::string">left or right</input_port>
    <input_port name="speed" type="double" default="0.2"/>
    <output_port name="covered" type="double"/>
  </Action>
  <Decorator ID="Gently"><input_port name="force" type="int"/></Decorator>
  <Control ID="Vote"/>
  <Condition ID="DoorOpen"/>
</TreeNodesModel>"""


def tree(nodes: str, model: str = MODEL) -> str:
    inside = f'<BehaviorTree ID="Main"><Sequence>{nodes}</Sequence></BehaviorTree>'
    return f'<root BTCPP_format="4" main_tree_to_execute="Main">{inside}{model}</root>'


def graver(problems) -> list[tuple[str, str]]:
    return [(p.code, p.message) for p in problems if p.severity is not Severity.HINT]


RIGHT = tree(
    '<FollowWall side="left" covered="{way}"/><Gently force="3"><DoorOpen/></Gently>'
    '<Vote><DoorOpen/><AlwaysSuccess/></Vote><ScriptCondition code="way &lt; 2"/>'
)


def test_what_is_only_declared_passes_with_one_hint(check) -> None:
    (hint,) = check(RIGHT)
    assert (hint.severity, hint.code) == (Severity.HINT, "declared-only")
    assert "FollowWall, Gently, DoorOpen, Vote" in hint.message
    assert "skills stub" in hint.hint
    assert "--substitute" in hint.hint


@pytest.mark.parametrize(
    ("nodes", "code", "said"),
    [
        ('<FollowWall side="left" sped="1"/>', "unknown-port", "FollowWall has no port 'sped'"),
        ("<FollowWall/>", "missing-input", "FollowWall needs the input 'side'"),
        ('<FollowWall side="left" speed="fast"/>', "wrong-value", "'speed'"),
        ('<FollowWall side="left" covered="2"/>', "not-a-key", "'covered' is an output of"),
        ("<Gently force='1'/>", "children", "Gently has no child"),
        ("<Vote/>", "children", "Vote has no children; at least 1"),
        ("<DoorOpen><AlwaysSuccess/></DoorOpen>", "children", "DoorOpen has 1 child; at most 0"),
        ('<FollowWall side="{where}"/>', "read-before-write", "nothing writes {where}"),
        ("<FolowWall side='left'/>", "unknown-node", "no node is called 'FolowWall'"),
    ],
)
def test_uses_are_checked_against_the_model(check, nodes: str, code: str, said: str) -> None:
    (found,) = graver(check(tree(nodes)))
    assert found[0] == code
    assert said in found[1]


def test_a_declared_type_is_that_of_the_key(check) -> None:
    wrong = '<FollowWall side="left" covered="{way}"/><say text="{way}"/>'
    (found,) = graver(check(tree(wrong)))
    assert found[0] == "wrong-type"


def test_models_in_yaml_declare_too(check) -> None:
    text = (
        "momantu_bt: 1\nmodels:\n  - Action: FollowWall\n    ports: [{in: side, type: text}]\n"
        "trees:\n  Main:\n    - FollowWall: left\n    - FollowWall: {sde: left, side: right}\n"
    )
    assert graver(check(text)) == [("unknown-port", "FollowWall has no port 'sde'")]


UNKNOWN = tree(
    '<Scan found="{it}"/><Each of="{it}" item="{one}"><Show what="{one}"/></Each>'
    '<Show what="{host}"/><SubTree ID="Elsewhere" a="{it}" b="{new}"/><Show what="{new}"/>'
    '<Script code="n := new"/><Show what="{n}"/>',
    "",
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "t.xml"
    path.write_text(UNKNOWN, encoding="utf-8")
    return path


def test_what_is_undeclared_is_an_error_or_one_warning_each(file: Path, capsys: Out) -> None:
    assert main(["check", str(file), "--json"]) == 2
    (strict,) = json.loads(capsys.readouterr().out)["trees"]
    errors = [p["code"] for p in strict["problems"] if p["severity"] == "error"]
    assert errors.count("unknown-node") == 6
    assert errors.count("unknown-tree") == 1
    assert main(["check", str(file), "--json", "--undeclared", "warn"]) == 0
    (mild,) = json.loads(capsys.readouterr().out)["trees"]
    told = [p["message"] for p in mild["problems"]]
    assert told == [
        "no node is called 'Scan'",
        "no node is called 'Each'",
        "no node is called 'Show' (4 nodes)",
        "no tree is called 'Elsewhere'",
    ]


def test_show_needs_nothing_that_stands_elsewhere(file: Path, capsys: Out) -> None:
    assert main(["show", str(file)]) == 0
    told = capsys.readouterr().out
    assert "Elsewhere" in told
    assert "Scan" in told
    for drawing in ("--svg", "--dot", "--mermaid"):
        assert main(["show", str(file), drawing]) == 0
        assert "Each" in capsys.readouterr().out


def test_a_tree_in_a_further_file_is_found_and_checked(tmp_path: Path, capsys: Out) -> None:
    main_file, folder = tmp_path / "t.xml", tmp_path / "others" / "deep"
    folder.mkdir(parents=True)
    main_file.write_text(tree('<SubTree ID="Part" n="3"/>', ""), encoding="utf-8")
    other = folder / "part.xml"
    part = '<BehaviorTree ID="Part"><Sleep msec="{n}"/></BehaviorTree>'
    other.write_text(f'<root BTCPP_format="4">{part}</root>', encoding="utf-8")
    (folder / "broken.xml").write_text("<root", encoding="utf-8")
    assert main(["check", str(main_file)]) == 2
    assert "--include" in capsys.readouterr().err
    for include in (other, tmp_path / "others"):
        assert main(["check", str(main_file), "--include", str(include)]) == 0
        assert "no errors in 2 trees" in capsys.readouterr().out
        assert main(["run", str(main_file), "--include", str(include), "--world", "none"]) == 0
        capsys.readouterr()
    other.write_text(other.read_text().replace("msec=", "mesc="), encoding="utf-8")
    assert main(["check", str(main_file), "--include", str(other)]) == 2
    assert "part.xml:1" in capsys.readouterr().err
    assert main(["check", str(main_file), "--include", str(tmp_path / "none")]) == 2
    assert "neither a tree file nor a folder" in capsys.readouterr().err


RULES = """momantu_bt: 1
substitute:
  - {node: FollowWall, status: SUCCESS, outputs: {covered: 1.5}}
  - {node: Gently, status: SUCCESS}
  - {node: Vote, status: SUCCESS}
"""


def test_a_run_needs_every_node_or_a_rule_that_replaces_it(tmp_path: Path, capsys: Out) -> None:
    file, rules = tmp_path / "t.xml", tmp_path / "rules.yaml"
    file.write_text(RIGHT, encoding="utf-8")
    assert main(["run", str(file), "--world", "none"]) == 2
    told = capsys.readouterr().err
    assert "nothing here has the node 'FollowWall', which the run may need" in told
    assert "skills stub" in told
    assert "--substitute" in told
    rules.write_text(RULES, encoding="utf-8")
    run = ["run", str(file), "--world", "none", "--substitute", str(rules)]
    assert main(run) == 0
    assert "FollowWall" in capsys.readouterr().out
    rules.write_text(RULES.replace("covered: 1.5}", "covered: 1.5}, times: 1"), encoding="utf-8")
    assert main(run) == 2
    assert "only so many times" in capsys.readouterr().err
    rules.write_text(RULES.replace("covered", "coverd"), encoding="utf-8")
    assert main(run) == 2
    assert "did you mean covered" in capsys.readouterr().err


def test_undeclared_nodes_and_trees_can_be_replaced_too(
    file: Path, tmp_path: Path, capsys: Out
) -> None:
    rules = tmp_path / "rules.yaml"
    wanted = ["Scan", "Each", "Show", "Elsewhere"]
    lines = [f"  - {{node: {name}, status: SUCCESS}}\n" for name in wanted]
    lines[3] = "  - {node: Elsewhere, status: SUCCESS, outputs: {a: 1, b: 2}}\n"
    rules.write_text(f"momantu_bt: 1\nsubstitute:\n{''.join(lines)}", encoding="utf-8")
    record = tmp_path / "record"
    run = ["run", str(file), "--world", "none", "--substitute", str(rules)]
    assert main([*run, "--record", str(record)]) == 0, capsys.readouterr().err
    assert main(["replay", str(record), "--check"]) == 0, capsys.readouterr().err


TWO_JOBS = """momantu_bt: 1
world: four_rooms
include: [bring_object.yaml]
main: TwoJobs
trees:
  TwoJobs:
    - BringObject:
        object: {category: can, diameter: 70 mm, height: 130 mm}
        from: table_a
        to: table_b
        tag_id: 1
        tag_edge: 150 mm
    - BringObject:
        {object: {category: can}, from: table_b, to: table_a, tag_id: 2, tag_edge: 15 cm}
"""


def test_bring_object_is_a_subtree_of_another_tree(tmp_path: Path, capsys: Out) -> None:
    folder = Path(__file__).resolve().parents[3] / "trees"
    text = (folder / "bring_object.yaml").read_text(encoding="utf-8")
    (tmp_path / "bring_object.yaml").write_text(text, encoding="utf-8")
    file, rules = tmp_path / "two.yaml", tmp_path / "rules.yaml"
    file.write_text(TWO_JOBS, encoding="utf-8")
    assert main(["check", str(file)]) == 0
    wanted = ["Fold", "Take", "Put"]
    lines = "".join(f"  - {{node: {name}, status: SUCCESS, delay: 1 s}}\n" for name in wanted)
    rules.write_text(f"momantu_bt: 1\nsubstitute:\n{lines}", encoding="utf-8")
    capsys.readouterr()
    assert main(["run", str(file), "--world", "none", "--substitute", str(rules)]) == 0
    assert capsys.readouterr().out.count("Put at $to") == 4  # it starts and ends, in both jobs
    file.write_text(TWO_JOBS.replace("from: table_b", "from: tabel_b"), encoding="utf-8")
    assert main(["check", str(file)]) == 2
    assert "two.yaml:14" in capsys.readouterr().err


@pytest.mark.parametrize(("text", "right"), [("1.500", True), ("01", True), ("fast", False)])
def test_a_text_given_to_a_tree_is_checked_where_a_number_is_read(
    check, text: str, right: bool
) -> None:
    inside = '<RateController hz="{speed}"><AlwaysSuccess/></RateController>'
    found = check(
        '<root BTCPP_format="4" main_tree_to_execute="Main">\n'
        f'<BehaviorTree ID="Main"><SubTree ID="Part" speed="{text}"/></BehaviorTree>\n'
        f'<BehaviorTree ID="Part">{inside}</BehaviorTree></root>'
    )
    assert graver(found) == [] if right else found[0].code == "wrong-value"
    assert right or (found[0].place.line, "at 'hz'" in found[0].message) == (2, True)
