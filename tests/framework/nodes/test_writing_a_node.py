"""Nodes of other packages: the page's example works, and is told of like built-in nodes."""

from __future__ import annotations

import importlib
import json
import re
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import py_trees
import pytest

import momantu_bt
from momantu_bt import plugins
from momantu_bt.bench.planning.made_of import made_of
from momantu_bt.cli import main
from momantu_bt.engine.build import build
from momantu_bt.engine.context import RunContext
from momantu_bt.py_trees_bridge.view import view
from momantu_bt.skill import Skill
from momantu_bt.testing import ManualClock
from momantu_bt.tree.catalogue import NODES, SPELLED
from momantu_bt.tree.load import load
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.registry import Registry

PAGE = Path(__file__).resolve().parents[3] / "docs" / "writing_a_node.md"
FILE = re.compile(r"Save as `([\w/.]+)`:\n\n```\w+\n(.*?)```", re.DOTALL)
GROUP = "momantu_bt.nodes"


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The page's files, in the working folder; its nodes are installed."""
    files = dict(FILE.findall(PAGE.read_text(encoding="utf-8")))
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path / "src")
    declared = re.findall(r'^(\w+) = "(pace_nodes[\w.:]+)"$', files["pyproject.toml"], re.MULTILINE)
    install(monkeypatch, *(EntryPoint(name, value, GROUP) for name, value in declared))
    yield files
    for name in [name for name in sys.modules if name.startswith("pace_nodes")]:
        del sys.modules[name]


def install(monkeypatch: pytest.MonkeyPatch, *entries: EntryPoint) -> None:
    find = plugins.entry_points

    def found(group: str) -> list[EntryPoint]:
        return [*find(group=group), *(entry for entry in entries if entry.group == group)]

    monkeypatch.setattr(plugins, "entry_points", found)


def test_the_pages_own_test_passes(package, capsys):
    page = {}
    exec(package["tests/test_pace.py"], page)
    tests = [value for name, value in page.items() if name.startswith("test_")]
    assert len(tests) == 1
    for test in tests:
        test()


def test_it_is_checked_shown_and_converted_both_ways(package, capsys):
    assert main(["check", "tree.yaml"]) == 0
    capsys.readouterr()
    assert main(["show", "tree.yaml"]) == 0
    shown = capsys.readouterr().out
    assert "(then not for 0.4 s)" in shown
    assert "race" in shown
    assert main(["convert", "tree.yaml", "-o", "tree.xml"]) == 0
    xml = Path("tree.xml").read_text(encoding="utf-8")
    assert '<Cooldown pause="0.4 s">' in xml
    assert "<Race>" in xml
    assert main(["convert", "tree.xml", "-o", "back.yaml"]) == 0
    assert load("back.yaml").document.trees == load("tree.yaml").document.trees


def test_it_is_recorded_and_replays_the_same(package, tmp_path, capsys):
    record = tmp_path / "record"
    report = momantu_bt.run("tree.yaml", world="none", record=record)
    assert {"cooldown", "race"} <= {node.name for node in report.nodes}
    capsys.readouterr()
    assert main(["replay", str(record), "--check"]) == 0


def test_editors_know_it(package, capsys):
    assert main(["skills", "schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert {"cooldown", "race"} <= set(schema["$defs"]["mapping"]["properties"])
    assert main(["skills", "--xml-model"]) == 0
    assert 'ID="Cooldown"' in capsys.readouterr().out


def test_its_page_says_what_it_takes(package, tmp_path, capsys):
    assert main(["skills", "show", "cooldown"]) == 0
    shown = capsys.readouterr().out
    assert "pause: number in s, at least 0, required. how long after an end" in shown
    assert "In XML    Cooldown" in shown
    assert main(["skills", "show", "race", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["children"] == [1, None]
    assert main(["skills", "pages", str(tmp_path / "pages")]) == 0
    page = (tmp_path / "pages" / "cooldown.md").read_text(encoding="utf-8")
    assert "| `pause` | number in s, at least 0 | required | how long after an end |" in page


def test_a_benchs_rows_know_its_package(package):
    made = made_of(load("tree.yaml").document, Registry.installed(), world="none")
    assert "the code of pace_nodes" in made


def test_py_trees_displays_draw_it(package):
    document = load("tree.yaml").document
    built = build(document, RunContext(ManualClock()), {}.__getitem__)
    assert "race" in py_trees.display.ascii_tree(view(built.root))


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("cooldown: 0.4 s", "cooldown: 0.4 m", "expected a time"),
        ("cooldown: 0.4 s", "cooldown: -1 s", "at least 0"),
        ("    - race:\n        - wait: 10 s\n", "    - race: []\n    - race:\n", "race"),
    ],
)
def test_its_ports_and_children_are_checked(package, capsys, before, after, said):
    text = package["tree.yaml"]
    assert before in text
    Path("tree.yaml").write_text(text.replace(before, after), encoding="utf-8")
    assert main(["check", "tree.yaml"]) != 0
    assert said in "".join(capsys.readouterr())


def test_what_a_node_without_a_flow_leaves_is_not_counted_on(package, capsys):
    Path("tree.yaml").write_text(
        "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n"
        "    - race:\n        - set: {key: $a, value: 1}\n"
        "    - set: {key: $b, value: $a}\n    - condition: $b == 1\n",
        encoding="utf-8",
    )
    assert main(["check", "tree.yaml"]) != 0
    assert "$a may have no value here" in "".join(capsys.readouterr())


BROKEN = {
    "from momantu_bt.nodes import x": "cannot be loaded: ImportError",
    "Calm = 5": "is broken: int is not a class",
    "class Calm: pass": "is not a subclass of",
    "class Calm(TreeNode): pass": "has no `spec`",
    "class Calm(TreeNode): spec = control('Calm', 'quiet', 'Waits.')": "is spelled quiet",
    "class Calm(TreeNode): spec = control('Quiet', 'calm', 'Waits.')": "it is 'Calm'",
    "class Calm(TreeNode): spec = leaf('Calm', 'calm', 'Waits.', keys=('k',))": "port 'k'",
    "class Calm(TreeNode): spec = leaf('Calm', 'calm', ' ')": "has no doc",
    "class Calm(TreeNode): spec = leaf('Calm', 'calm', 'W.', input_port('child', int, 'c'))": "hi",
    "class Calm(TreeNode): spec = leaf('Calm', 'calm', 'Waits.')": "Calm has no `step`",
    "class Calm(TreeNode): spec = leaf('Calm', 'calm', 'W.', codes=('A',))": "and_also('CODE')",
    "class Calm(TreeNode): spec = control('Calm', 'calm', 'W.', children=2)": "(least, most)",
    "class Calm(TreeNode): spec = control('Calm', 'calm', 'W.', roles='r')": "expected a function",
    "class Calm(TreeNode): spec = control('Calm', 'calm', 'W.', keys=3)": "TypeError",
}


@pytest.mark.parametrize("text", BROKEN)
def test_a_broken_node_is_told_by_who_uses_it_and_by_the_doctor(
    tmp_path, monkeypatch, capsys, text
):
    module = f"calm_{abs(hash(text))}"
    imports = "from momantu_bt.nodes import TreeNode, control, input_port, leaf\n"
    (tmp_path / f"{module}.py").write_text(f"{imports}{text}\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    install(monkeypatch, EntryPoint("calm", f"{module}:Calm", GROUP))
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\nmain: Main\ntrees:\n  Main: {calm: }\n", encoding="utf-8")
    assert main(["check", str(tree)]) != 0
    said = "".join(capsys.readouterr())
    assert "the node 'calm'" in said
    assert BROKEN[text] in said.replace("\n", " ")
    assert "Sequence" in NODES


def test_two_packages_with_one_name_are_told(tmp_path, monkeypatch, capsys):
    install(
        monkeypatch, EntryPoint("calm", "one:Calm", GROUP), EntryPoint("calm", "two:Calm", GROUP)
    )
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\nmain: Main\ntrees:\n  Main: {calm: }\n", encoding="utf-8")
    assert main(["check", str(tree)]) != 0
    assert "two plug-ins are called 'calm'" in "".join(capsys.readouterr())


def test_a_node_does_not_replace_a_built_in_one(package, monkeypatch, capsys):
    install(monkeypatch, EntryPoint("retry", "pace_nodes.pace:Race", GROUP))
    assert SPELLED["retry"].type == "RetryUntilSuccessful"
    main(["doctor"])
    assert "'retry' is a built-in node" in "".join(capsys.readouterr())


def test_a_node_may_have_any_name_and_one_node_has_a_tag(package, monkeypatch, capsys):
    Path("src/pace_nodes/named.py").write_text(
        "from momantu_bt.nodes import leaf, SUCCESS, TreeNode\n"
        "class Any(TreeNode):\n"
        "    spec = leaf('Go-There', 'Go-There', 'Succeeds.')\n"
        "    def step(self): return SUCCESS\n"
        "class Same(Any):\n"
        "    spec = leaf('Cooldown', 'Cooldown', 'Succeeds.')\n",
        encoding="utf-8",
    )
    named = "pace_nodes.named:"
    install(monkeypatch, EntryPoint("Go-There", f"{named}Any", GROUP))
    Path("a.yaml").write_text("momantu_bt: 1\ntrees: {Main: [Go-There]}\n", encoding="utf-8")
    assert main(["run", "a.yaml", "--world", "none"]) == 0
    assert main(["convert", "a.yaml"]) == 0
    assert "<Go-There/>" in capsys.readouterr().out
    install(monkeypatch, EntryPoint("Cooldown", f"{named}Same", GROUP))
    Path("b.yaml").write_text("momantu_bt: 1\ntrees: {Main: [Cooldown]}\n", encoding="utf-8")
    assert main(["check", "b.yaml"]) == 2
    assert "is a node that XML calls Cooldown too" in capsys.readouterr().err


def test_a_node_does_not_take_the_name_of_a_skill(package, monkeypatch, capsys):
    skill = next(iter(SKILLS))
    install(monkeypatch, EntryPoint(skill, "pace_nodes.pace:Race", GROUP))
    assert skill not in SPELLED
    assert issubclass(SKILLS.load(skill), Skill)
    main(["doctor"])
    assert f"{skill!r} is an installed skill" in "".join(capsys.readouterr()).replace("\n", " ")


CALM = """from momantu_bt.nodes import Decorator, SUCCESS, TreeNode, control, decorator, leaf
class Calm({base}):
    \"\"\"Waits.\"\"\"
    spec = {kind}("Calm", "calm", "Waits.", {further})
    {method}
"""


@pytest.fixture
def calm(tmp_path, monkeypatch, capsys):
    """What a command says of a tree in which a node of another package does something."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)

    def told(verb, tree="calm", method="def step(self): return SUCCESS", further="", kind="leaf"):
        module = f"calm_{abs(hash((method, further, kind)))}"
        base = "Decorator" if kind == "decorator" else "TreeNode"
        text = CALM.format(base=base, kind=kind, further=further, method=method)
        Path(f"{module}.py").write_text(text, encoding="utf-8")
        importlib.invalidate_caches()
        install(monkeypatch, EntryPoint("calm", f"{module}:Calm", GROUP))
        text = f"momantu_bt: 1\ntrees:\n  Main:\n    - {tree}\n"
        Path("tree.yaml").write_text(text, encoding="utf-8")
        code = main(verb.split())
        return code, "".join(capsys.readouterr())

    return told


RUN = "run tree.yaml --world none"


@pytest.mark.parametrize(
    ("tree", "where"),
    [("{calm: [succeed]}", "tree.yaml:4:8"), ("{succeed: , calm: 3 s}", "tree.yaml:4:19")],
)
def test_a_broken_node_is_told_also_with_children_and_beside_a_node(calm, tree, where):
    code, said = calm("check tree.yaml", tree, further="children=2", kind="control")
    assert code == 2
    assert f"{where}: error: the node 'calm'" in said
    assert "1 error;" in said


@pytest.mark.parametrize(
    ("method", "said"),
    [
        (
            "def step(self): return {}['a']",
            "KeyError: 'a', in the node calm (tree.yaml:4), at {file}:5: def step",
        ),
        ("def step(self): pass", "TypeError: step() returned None; expected one of RUNNING"),
        ("def step(self): return self.shown", "step() returned <Status.IDLE"),
        ("def step(self): return self.fail('no way', 'x')", "'no way' is not upper-case words"),
    ],
)
def test_a_node_that_raises_or_returns_no_status_is_named(calm, monkeypatch, method, said):
    code, told = calm(RUN, method=method)
    assert code == 4
    last = next(line for line in told.splitlines() if "internal error after" in line)
    (file,) = (path.name for path in Path().glob("calm_*.py"))
    assert said.replace("{file}", file) in last
    assert "in the node calm (tree.yaml:4)" in last
    assert "Traceback" not in told
    monkeypatch.setenv("MOMANTU_BT_TRACEBACK", "1")
    assert "Traceback" in calm(RUN, method=method)[1]


def test_a_constructor_that_raises_is_told_without_a_traceback(calm):
    method = "def step(self): return SUCCESS\n    def __init__(self, parts): self.a = 1 / 0"
    code, said = calm(RUN, method=method)
    assert code == 2
    assert "tree.yaml:4:7: the node Calm cannot be made" in said
    assert "ZeroDivisionError" in said
    assert "Traceback" not in said


@pytest.mark.parametrize("argument", ["flow", "codes", "objection"])
def test_a_function_of_a_spec_that_raises_is_named(calm, argument):
    code, said = calm("check tree.yaml", further=f"{argument}=lambda *given: 1 / 0")
    assert code == 2
    assert f"the node 'calm' is broken: its spec's `{argument}` raised ZeroDivisionError" in said


def test_a_word_of_a_spec_that_raises_is_named(calm):
    tree = "{succeed: , calm: }"
    code, said = calm("show tree.yaml", tree, further="around=lambda n: 1 / 0", kind="decorator")
    assert code == 2
    assert "the node 'calm' is broken: its spec's `around` raised ZeroDivisionError" in said


def test_a_control_node_that_is_not_installed_is_told_so(tmp_path, capsys):
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\ntrees:\n  Main:\n    - majority: [succeed]\n", encoding="utf-8")
    assert main(["check", str(tree)]) == 2
    said = "".join(capsys.readouterr())
    assert "a control node of another package has to be installed" in said


def test_a_broken_node_does_not_hide_the_skill_of_its_name(tmp_path, monkeypatch, capsys):
    install(monkeypatch, EntryPoint("look", "no_such_module:Look", GROUP))
    tree = tmp_path / "tree.yaml"
    tree.write_text("momantu_bt: 1\ntrees: {Main: [look: {ahead: 1 m}]}\n", encoding="utf-8")
    main(["check", str(tree)])
    assert "the node 'look'" not in "".join(capsys.readouterr())


def test_a_behaviour_does_not_hide_the_node_of_another_package(package, monkeypatch, capsys):
    behaviour = EntryPoint("race", "py_trees.behaviours:Success", "momantu_bt.behaviours")
    install(monkeypatch, behaviour)
    assert SPELLED["race"].type == "Race"
    main(["doctor"])
    assert "'race' is the node of another package" in "".join(capsys.readouterr())
