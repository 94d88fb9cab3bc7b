"""Faults in a tree and with skills that nobody here has heard of."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

import pytest

from momantu_bt import plugins
from momantu_bt.activity import Activity
from momantu_bt.cli import main
from momantu_bt.fault_kind import Trigger, Where, fault_kind
from momantu_bt.faults.kinds.catalogue import FAULTS, kinds
from momantu_bt.faults.kinds.reasons import true_reasons
from momantu_bt.faults.kinds.triggers import activities_of
from momantu_bt.faults.tree_page import TreeRow, tree_rows
from momantu_bt.messages import DetectedObject
from momantu_bt.plugins import PluginClash, PluginError
from momantu_bt.robot import ARM
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_bt.tree.load import load
from momantu_bt.tree.plugins import SKILLS
from momantu_bt.tree.registry import Registry

TREE = """
momantu_bt: 1
main: Main
trees:
  Main: [Once, {wait: 1 s}, Again]
  Once: {turn_round: {angle: 0.5}}
  Again: {turn_round: {angle: -0.5}}
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A package made by `skills new`, installed beside all others."""
    assert main(["skills", "new", "turn_round", "--into", str(tmp_path)]) == 0
    folder = tmp_path / "turn_round"
    monkeypatch.syspath_prepend(folder / "src")
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
    (value,) = project["project"]["entry-points"][SKILLS.name].values()
    mine = EntryPoint("turn_round", value, SKILLS.name)

    def found(group: str) -> list[EntryPoint]:
        return [*entry_points(group=group), *([mine] if group == SKILLS.name else [])]

    monkeypatch.setattr(plugins, "entry_points", found)
    yield
    for module in [each for each in sys.modules if each.startswith("turn_round_skill")]:
        del sys.modules[module]


def rows_of(tree: Path) -> dict[str, TreeRow]:
    registry = Registry.installed()
    rows = tree_rows(load(str(tree), registry).document, registry)
    return {row.row.fault: row for row in rows}


@pytest.mark.usefixtures("package")
def test_a_skill_that_declares_nothing_takes_part(tmp_path: Path) -> None:
    tree = tmp_path / "turning.yaml"
    tree.write_text(TREE, encoding="utf-8")
    rows = rows_of(tree)
    skill = SKILLS.load("turn_round")
    own = set(skill.failures)
    assert "base" in skill.uses
    assert own
    assert rows["base.stuck"].begins == rows["laser.dead"].begins == "turn_round"
    assert rows["skill.hang"].begins == rows["process.killed"].begins == "turn_round"
    assert own <= rows["base.stuck"].row.reasons
    assert own <= rows["laser.dead"].row.reasons
    assert not own & rows["arm.stuck"].row.reasons, "it does not use the arm"
    assert not own & rows["skill.exception"].row.reasons


@pytest.mark.usefixtures("package")
def test_its_tree_says_the_rest(tmp_path: Path) -> None:
    tree = tmp_path / "turning.yaml"
    tree.write_text(TREE, encoding="utf-8")
    tree.with_name("turning.faults.yaml").write_text(
        "momantu_bt: 1\nbegins: {base.stuck: Again/turn_round}\nrows: [base.slow@Once]\n"
    )
    rows = rows_of(tree)
    assert rows["base.stuck:for=inf"].begins == "Again/turn_round"
    assert rows["base.slow@Once"].begins == "Once"


class Scoop(Skill):
    """Takes something up with a spoon."""

    size: float = In(1.0, doc="how much")
    failures = {"EMPTY": "the spoon came up empty", "BAD_SPOON": "there is no such spoon"}
    uses = {ARM, "gripper"}
    activities = {Activity.GRASP: "/closing"}
    symptoms = {"EMPTY": {Symptom.NOT_HELD}}

    def run(self, robot) -> Run:
        yield "closing"


class Spot(Skill):
    """Sees things."""

    seen: tuple[DetectedObject, ...] = Out(doc="what it sees")
    failures = {"BLIND": "no picture came"}

    def run(self, robot) -> Run:
        yield "looking"


SPILLED = fault_kind(
    "spoon.spilled",
    "The spoon is turned over.",
    place=Where.WORLD,
    begins=(Trigger(Activity.GRASP, after=2.0),),
    notice=5.0,
    recoverable=False,
    symptoms={Symptom.NOT_HELD},
)


def test_symptoms_join_faults_and_codes_that_do_not_know_each_other() -> None:
    assert true_reasons(SPILLED, [Scoop]) == {"EMPTY"}
    assert true_reasons(kinds()["gripper.slips"], [Scoop]) == {"EMPTY"}
    assert true_reasons(kinds()["laser.dead"], [Scoop]) == {"SENSOR_DEAD"}
    assert true_reasons(kinds()["camera.dead"], [Spot]) == {"SENSOR_DEAD", "BLIND"}
    assert true_reasons(kinds()["base.stuck"], [Spot]) == set()


def test_activities_are_as_declared_else_as_they_seem() -> None:
    assert dict(activities_of(Scoop)) == {Activity.GRASP: "/closing", Activity.ANY: ""}
    assert set(activities_of(Spot)) == {
        Activity.FIND_OBJECT,
        Activity.LOOK,
        Activity.ANY,
        Activity.ANSWER,
    }


def with_faults(monkeypatch: pytest.MonkeyPatch, **rows: tuple[object, ...]) -> None:
    """Install lists of faults beside all others."""
    entries = [EntryPoint(name, f"{__name__}:{name}", FAULTS.name) for name in rows]
    module = sys.modules.get(__name__) or type(sys)(__name__)
    for name, value in rows.items():
        monkeypatch.setattr(module, name, value, raising=False)
    monkeypatch.setitem(sys.modules, __name__, module)

    def found(group: str) -> list[EntryPoint]:
        return [*entry_points(group=group), *(entries if group == FAULTS.name else [])]

    monkeypatch.setattr(plugins, "entry_points", found)


def test_a_package_brings_kinds_of_its_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with_faults(monkeypatch, of_mine=(SPILLED,))
    assert kinds()["spoon.spilled"] is SPILLED
    assert main(["faults", "show", "spoon.spilled"]) == 0
    assert "after-pick+2 s" in capsys.readouterr().out


def test_two_faults_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with_faults(monkeypatch, of_mine=(SPILLED,), of_others=(SPILLED,))
    with pytest.raises(PluginClash, match=r"a fault 'spoon\.spilled': .*of_mine and .*of_others"):
        kinds()


def test_a_broken_list_of_faults_is_told_and_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    with_faults(monkeypatch, broken=("spoon.spilled",))
    assert "camera.dead" in kinds()
    assert "spoon.spilled" not in kinds()
    with pytest.raises(PluginError, match="is not a tuple of momantu_bt.fault_kind.FaultKind"):
        FAULTS.load("broken")
