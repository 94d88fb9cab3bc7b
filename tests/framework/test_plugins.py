"""Plug-ins are found by name; a broken one is told with its name, and the others go on working."""

import json
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from momantu_bt import plugins
from momantu_bt.cli import main
from momantu_bt.diagnosis.plugins import plugins as diagnosed
from momantu_bt.plugins import Group, PluginClash, PluginError
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.catalogue import MODIFIERS, NODES, SPELLED
from momantu_bt.tree.plugins import SERVICES, SKILLS
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.skill_objection import bad_skill_name
from momantu_bt.world_plugins import WORLDS

GOOD = '''
from momantu_bt import In, Robot, Run, Skill


class Good(Skill):
    """Does nothing, well."""

    angle: float = In(0.3, unit="rad", doc="how far")
    failures = {"TOO_FAR": "it does not go that far"}

    def run(self, robot: Robot) -> Run:
        yield "once"
'''


@pytest.fixture
def entries(monkeypatch: pytest.MonkeyPatch) -> list[EntryPoint]:
    having: list[EntryPoint] = []
    monkeypatch.setattr(
        plugins, "entry_points", lambda group: [e for e in having if e.group == group]
    )
    return having


def entry(name: str, value: str, group: str = SKILLS.name) -> EntryPoint:
    return EntryPoint(name, value, group)


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest):
    """`module(text)`: the name of a module with that text, which can be imported in this test."""
    monkeypatch.syspath_prepend(tmp_path)
    made: list[str] = []

    def write(text: str) -> str:
        made.append(f"plugin_of_a_test_{len(made)}")
        (tmp_path / f"{made[-1]}.py").write_text(text, encoding="utf-8")
        return made[-1]

    yield write
    for name in made:
        sys.modules.pop(name, None)


def test_names_come_in_order(entries: list[EntryPoint]) -> None:
    entries += [entry("b", "m:B"), entry("a", "m:A")]
    assert list(SKILLS) == ["a", "b"]


def test_two_of_one_name_are_both_named_and_harm_nobody(entries: list[EntryPoint], module) -> None:
    good = module(GOOD)
    entries += [entry("a", "one:A"), entry("a", "two:A"), entry("good", f"{good}:Good")]
    assert list(SKILLS) == ["a", "good"]
    with pytest.raises(PluginClash, match=r"one:A .* two:A"):
        SKILLS.load("a")
    assert SKILLS.load("good").__name__ == "Good"


def test_the_same_one_twice_is_one(entries: list[EntryPoint], module) -> None:
    good = module(GOOD)
    entries += [entry("good", f"{good}:Good"), entry("good", f"{good}:Good")]
    assert SKILLS.load("good").__name__ == "Good"


def test_an_unknown_name_is_answered_with_the_nearest(entries: list[EntryPoint]) -> None:
    entries.append(entry("navigate", "m:N"))
    with pytest.raises(PluginError, match="did you mean 'navigate'"):
        SKILLS.load("navigat")


BROKEN = {
    "No module named 'no_such_module'": "import no_such_module",
    "SyntaxError": "def",
    "SystemExit": "raise SystemExit(3)",
    "has no attribute 'Good'": "",
    "not a subclass of momantu_bt.Skill": "class Good: pass",
    "function is not a subclass": "def Good(): pass",
    "has no docstring": GOOD.replace('"""Does nothing, well."""', ""),
    "Good.angle has no doc": GOOD.replace('doc="how far"', 'doc=" "'),
    "Good.angle has no type": GOOD.replace("angle: float", "angle"),
    "its type must be imported at run time": GOOD.replace("angle: float", 'angle: "Angle"'),
    "3 is not a type": GOOD.replace("angle: float", "angle: 3"),
    "not UPPER_CASE words": GOOD.replace("TOO_FAR", "too far"),
    "no sentence explains TOO_FAR": GOOD.replace("it does not go that far", ""),
    "not a mapping of codes": GOOD.replace('{"TOO_FAR": "it does not go that far"}', "set()"),
    "uses is not a set": GOOD.replace("    failures", '    uses = "base"\n    failures'),
    "activities: 'any' is not an activity": GOOD.replace(
        "    failures", '    activities = {"any": ""}\n    failures'
    ),
    "activities: 'closing' is not '', '/PHASE' or '+3 s'": GOOD.replace(
        "    failures", '    activities = {"grasps an object": "closing"}\n    failures'
    ),
    "symptoms: 'FAR' is not among its failures: TOO_FAR": GOOD.replace(
        "    failures", '    symptoms = {"FAR": set()}\n    failures'
    ),
    "symptoms: TOO_FAR has {'gone'}; expected a set of Symptom": GOOD.replace(
        "    failures", '    symptoms = {"TOO_FAR": {"gone"}}\n    failures'
    ),
    "has no run": GOOD.replace("def run", "def walk"),
}
"""Part of the reason, and a module `Good` of which is broken in that way."""


@pytest.mark.parametrize("reason", BROKEN)
def test_a_broken_skill_is_named_with_the_reason(
    entries: list[EntryPoint], module, reason: str
) -> None:
    name = module(BROKEN[reason])
    entries.append(entry("good", f"{name}:Good"))
    with pytest.raises(PluginError) as raised:
        SKILLS.load("good")
    assert str(raised.value).startswith(f"the skill 'good' ({name}:Good of an unknown package) ")
    assert reason in str(raised.value)


@pytest.mark.parametrize(
    ("group", "value", "reason"),
    [
        (SERVICES, "momantu_bt.skill:Skill", "not a subclass of momantu_bt.Service"),
        (ROBOTS, "momantu_bt.port:NAMES", "not a function"),
        (WORLDS, "momantu_bt.skill:Skill", "has no name and no default_robot and no site"),
    ],
)
def test_other_plugins_are_checked_too(
    entries: list[EntryPoint], group: Group[object], value: str, reason: str
) -> None:
    entries.append(entry("a", value, group.name))
    with pytest.raises(PluginError, match=reason):
        group.load("a")


NO_NAMES = ["again", "Two Words", "2x", "if", "nav:Go", "a/b", "", "-a", "true", "SubTree"]
NAMES = ["FollowPath", "follow-path", "Follow.Path", "class", "_go", "Übergabe"]


@pytest.mark.parametrize("name", [*SPELLED, *NODES, *MODIFIERS, *NO_NAMES])
def test_a_name_that_means_something_else_is_refused(name: str) -> None:
    assert bad_skill_name(name)


@pytest.mark.parametrize("name", SKILLS)
def test_installed_names_are_good(name: str) -> None:
    assert bad_skill_name(name) is None
    assert SKILLS.load(name)


TREE = "momantu_bt: 1\ntrees:\n  Main:\n"


@pytest.mark.parametrize("name", NAMES)
def test_a_skill_of_any_name_stands_in_trees_of_both_spellings(
    entries: list[EntryPoint], module, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    entries.append(entry(name, f"{module(GOOD)}:Good"))
    first, xml, back = tmp_path / "a.yaml", tmp_path / "b.xml", tmp_path / "c.yaml"
    lines = [f"- {name}", f"- {name}: 2", f"- {name}: {{angle: 3}}"]
    lines.append(f"- recover: {{attempts: 2, try: {name}, catch: {{{name}.TOO_FAR: again}}}}")
    first.write_text(TREE + "".join(f"    {line}\n" for line in lines), encoding="utf-8")
    assert main(["convert", str(first), "-o", str(xml)]) == 0
    assert main(["convert", str(xml), "-o", str(back)]) == 0
    assert main(["check", *map(str, (first, xml, back))]) == 0, capsys.readouterr().err
    assert main(["show", str(first), str(back)]) == 0
    xml.write_text(xml.read_text().replace('angle="3"', 'angel="3"'), encoding="utf-8")
    assert main(["check", str(xml)]) == 2
    assert f"{name} has no port 'angel'" in capsys.readouterr().err
    for verb in (["show", str(first)], ["skills", "show", name], ["skills", "schema"]):
        assert main(verb) == 0
        told = capsys.readouterr().out
        assert name in told or json.dumps(name) in told


def test_a_tree_that_begins_with_a_capital_may_have_the_name_of_a_skill(
    entries: list[EntryPoint], module, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    entries.append(entry("FollowPath", f"{module(GOOD)}:Good"))
    inside = '<BehaviorTree ID="FollowPath"><Sleep msec="1"/></BehaviorTree>'
    tree = f'<root BTCPP_format="4">{inside}</root>'
    yaml = "momantu_bt: 1\ntrees:\n  FollowPath:\n    - wait: 1 s\n"
    for file, text in ((tmp_path / "a.xml", tree), (tmp_path / "a.yaml", yaml)):
        file.write_text(text, encoding="utf-8")
        assert main(["check", str(file)]) == 0
        assert main(["show", str(file)]) == 0
        assert "wait" in capsys.readouterr().out


def test_one_broken_skill_and_one_clash_leave_the_rest_alone(
    entries: list[EntryPoint], module, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    good, broken = module(GOOD), module("import no_such_module")
    entries += [entry("good", f"{good}:Good"), entry("ill", f"{broken}:Ill")]
    entries += [entry("twice", "one:A"), entry("twice", "two:A")]
    assert main(["skills", "list", "--json"]) == 1
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)}
    assert [name for name, row in rows.items() if row["ok"]] == ["good"]
    assert "no_such_module" in rows["ill"]["about"]
    assert "two plug-ins" in rows["twice"]["about"]
    wrong = {one.name: one for one in diagnosed([SKILLS]) if not one.ok}
    assert set(wrong) == {f"{SKILLS.name} ill", f"{SKILLS.name} twice"}
    assert "rename" in wrong[f"{SKILLS.name} twice"].cure
    file = tmp_path / "tree.yaml"
    for name, code in (("good", 0), ("ill", 2), ("twice", 2)):
        file.write_text(f"{TREE}    - {name}\n", encoding="utf-8")
        assert main(["check", str(file)]) == code
        assert ("[broken-plugin]" in capsys.readouterr().err) == bool(code)


def test_checking_a_tree_imports_only_what_it_names(
    entries: list[EntryPoint], module, tmp_path: Path
) -> None:
    good, other = module(GOOD), module(GOOD)
    entries += [entry("good", f"{good}:Good"), entry("other", f"{other}:Good")]
    file = tmp_path / "tree.yaml"
    file.write_text(f"{TREE}    - good\n", encoding="utf-8")
    assert main(["check", str(file)]) == 0
    assert good in sys.modules
    assert other not in sys.modules
    assert set(Registry.installed().skills) == {"good", "other"}


def test_the_public_names_are_completed():
    import momantu_bt

    assert dir(momantu_bt) == sorted(momantu_bt.__all__)
    assert {"run", "Skill", "Service"} <= set(dir(momantu_bt))


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("no_such_pkg.a:Good", "'no_such_pkg'; is the entry point spelt as the module"),
        ("{good}:Goood", "did you mean Good?"),
        ("{good}", "module is not a subclass of momantu_bt.Skill; write MODULE:NAME"),
        ("json:loads", "function is not a subclass of momantu_bt.Skill"),
    ],
)
def test_a_wrong_entry_point_says_what_would_be_right(
    entries: list[EntryPoint], module, value: str, said: str
) -> None:
    entries.append(entry("ill", value.replace("{good}", module(GOOD))))
    with pytest.raises(PluginError) as error:
        SKILLS.load("ill")
    assert said in str(error.value)
