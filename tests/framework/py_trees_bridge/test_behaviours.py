"""Behaviours of py_trees as leaves of tree files, and tree files as behaviours."""

from __future__ import annotations

import re
import runpy
from importlib.metadata import EntryPoint
from pathlib import Path

import py_trees
import pytest
from py_trees.common import Status

import momantu_bt
from momantu_bt import Failure, plugins
from momantu_bt.cli import main
from momantu_bt.engine.executor import Executor
from momantu_bt.nodes import input_port, output_port
from momantu_bt.nodes.behaviour import behaviour
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry

PAGE = Path(__file__).resolve().parents[3] / "docs" / "py_trees.md"
FILE = re.compile(r"Save as `([\w/.]+)`:\n\n```\w+\n(.*?)```", re.DOTALL)
GROUP = "momantu_bt.behaviours"
INSTALLED: dict[str, object] = {}
"""Behaviours of a test, by name."""


class Count(py_trees.behaviour.Behaviour):
    """Counts to a number, and notes what is asked of it."""

    up_to = 0
    events: list[str] = []

    def setup(self, **kwargs):
        self.events.append(f"setup {sorted(kwargs)}")

    def initialise(self):
        self.count = 0
        self.events.append("initialise")

    def update(self):
        self.count += 1
        self.feedback_message = f"at {self.count}"
        return Status.SUCCESS if self.count >= self.up_to else Status.RUNNING

    def terminate(self, new_status):
        self.events.append(f"terminate {new_status.value}")


class Told(Count):
    """The same, told by its constructor."""

    def __init__(self, name, up_to):
        super().__init__(name)
        self.up_to = up_to


class OnBoard(Count):
    """The same, told by py_trees' blackboard."""

    def __init__(self, name):
        super().__init__(name)
        self.board = self.attach_blackboard_client(name)
        self.board.register_key("up_to", py_trees.common.Access.READ)
        self.board.register_key("count", py_trees.common.Access.WRITE)

    def update(self):
        self.up_to = self.board.up_to
        status = super().update()
        self.board.count = self.count
        return status


class Wrong(py_trees.behaviour.Behaviour):
    """Does what its attribute says is wrong."""

    def update(self):
        if self.how == "raises":
            raise ZeroDivisionError("by zero")
        if self.how == "fails":
            raise Failure("NO_WAY", "there is no way")
        return {"invalid": Status.INVALID, "failure": Status.FAILURE}[self.how]


class Endless(py_trees.behaviour.Behaviour):
    """Has no update."""


class Stuck(Count):
    """Cannot be let go of."""

    def terminate(self, new_status):
        super().terminate(new_status)
        raise RuntimeError("stuck")


UP_TO = input_port("up_to", int, "how far", least=1)
COUNT = output_port("count", int, "what it came to", None)
HOW = input_port("how", str, "what it does")


@pytest.fixture(autouse=True)
def behaviours(monkeypatch: pytest.MonkeyPatch):
    INSTALLED.clear()
    Count.events.clear()
    INSTALLED.update(
        count=behaviour(Count, UP_TO, COUNT),
        told=behaviour(Told, UP_TO, COUNT, through="constructor"),
        on_board=behaviour(OnBoard, UP_TO, COUNT, through="blackboard"),
        wrong=behaviour(Wrong, HOW, failure="ALL_WRONG"),
        idle=py_trees.behaviours.Running,
    )
    install(monkeypatch, *INSTALLED)


def install(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    find = plugins.entry_points

    class Entry:
        """An entry point whose plug-in is this test's."""

        dist, module, attr = None, "test", "plugin"

        def __init__(self, name: str) -> None:
            self.name, self.value, self.group = name, f"test:{name}", GROUP

        def load(self) -> object:
            return INSTALLED[self.name]

    made = [Entry(name) for name in names]

    def found(group: str) -> list[EntryPoint]:
        return [*find(group=group), *(entry for entry in made if group == GROUP)]

    monkeypatch.setattr(plugins, "entry_points", found)


@pytest.fixture
def tree(tmp_path):
    def write(body: str) -> Path:
        file = tmp_path / "tree.yaml"
        file.write_text(f"momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n{body}", encoding="utf-8")
        return file

    return write


@pytest.mark.parametrize("name", ["count", "told", "on_board"])
def test_values_go_in_and_come_out_whichever_way_is_declared(tree, name):
    file = tree(f"    - {name}: {{up_to: 3, count: $n}}\n    - condition: $n == 3\n")
    report = momantu_bt.run(file, world="none")
    assert (report.status, report.ticks, report.blackboard) == ("SUCCESS", 3, {"n": 3})


def test_each_start_initialises_and_each_end_terminates_and_setup_comes_once(tree):
    file = tree("    - repeat: {cycles: 2, child: {count: 2}}\n")
    assert momantu_bt.run(file, world="none").status == "SUCCESS"
    once = ["initialise", "terminate SUCCESS"]
    assert Count.events == ["setup ['clock']", *once, *once]


def test_a_halt_terminates_with_invalid(tree):
    file = tree("    - {count: 100, timeout: 0.2 s}\n")
    report = momantu_bt.run(file, world="none")
    assert report.failure.code == "TIMEOUT"
    assert report.failure.cause.message.startswith("was running (at 4)")
    assert Count.events == ["setup ['clock']", "initialise", "terminate INVALID"]


def test_a_class_without_ports_needs_no_declaration(tree):
    report = momantu_bt.run(tree("    - {idle: , timeout: 0.1 s}\n"), world="none")
    assert report.failure.cause.node == "idle"


@pytest.mark.parametrize(
    ("how", "code", "said"),
    [
        ("raises", "BEHAVIOUR_ERROR", "raised ZeroDivisionError: by zero"),
        ("fails", "NO_WAY", "there is no way"),
        ("invalid", "ALL_WRONG", "returned INVALID"),
        ("failure", "ALL_WRONG", "returned FAILURE"),
    ],
)
def test_what_goes_wrong_is_a_failure_with_a_code(tree, how, code, said):
    report = momantu_bt.run(tree(f"    - wrong: {how}\n"), world="none")
    assert (report.failure.code, report.failure.message) == (code, said)
    assert report.failure.node_type == "wrong"


def test_an_output_of_another_type_is_refused(tree):
    INSTALLED["count"] = behaviour(Count, UP_TO, output_port("count", str, "no number"))
    report = momantu_bt.run(tree("    - count: {up_to: 1, count: $n}\n"), world="none")
    assert report.failure.code == "WRONG_TYPE"


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("    - count: 0\n", "at least 1"),
        ("    - count: {far: 1}\n", "far"),
        ("    - condition: $n > 1\n    - count: {up_to: 1, count: $n}\n", "$n"),
        ("    - handle: {try: {wrong: x}, catch: {NO_SUCH: succeed}}\n", "NO_SUCH"),
    ],
)
def test_a_leaf_is_checked(tree, capsys, body, said):
    assert main(["check", str(tree(body))]) != 0
    assert said in "".join(capsys.readouterr())


def test_a_declared_code_can_be_handled(tree):
    file = tree("    - handle: {try: {wrong: failure}, catch: {ALL_WRONG: succeed}}\n")
    assert momantu_bt.run(file, world="none").status == "SUCCESS"


def test_a_code_that_it_raises_can_be_declared_and_handled(tree):
    INSTALLED["wrong"] = behaviour(Wrong, HOW, failure="ALL_WRONG", codes=("NO_WAY",))
    file = tree("    - handle: {try: {wrong: fails}, catch: {NO_WAY: succeed}}\n")
    assert momantu_bt.run(file, world="none").status == "SUCCESS"


def test_an_unknown_way_for_values_is_told():
    with pytest.raises(ValueError, match="expected one of constructor, attributes, blackboard"):
        behaviour(Count, through="magic")


def test_a_halt_that_raises_halts_once_and_the_next_start_begins_anew(tree, capsys):
    INSTALLED["count"] = behaviour(Stuck, UP_TO)
    file = tree("    - repeat: {cycles: 2, child: {count: 100, timeout: 0.2 s, force: success}}\n")
    assert momantu_bt.run(file, world="none").status == "SUCCESS"
    once = ["initialise", "terminate INVALID"]
    assert Count.events == ["setup ['clock']", *once, *once]


def test_it_is_shown_and_converted_both_ways(tree, tmp_path, capsys):
    file = tree("    - count: {up_to: 3, count: $n}\n    - condition: $n == 3\n")
    assert main(["show", str(file)]) == 0
    assert "count up_to 3, count $n" in capsys.readouterr().out
    xml, back = tmp_path / "tree.xml", tmp_path / "back.yaml"
    assert main(["convert", str(file), "-o", str(xml)]) == 0
    assert '<count up_to="3" count="{n}"/>' in xml.read_text(encoding="utf-8")
    assert main(["convert", str(xml), "-o", str(back)]) == 0
    assert "count: {up_to: 3, count: $n}" in back.read_text(encoding="utf-8")


def test_a_replay_takes_it_from_the_record(tree, tmp_path, capsys):
    file = tree(
        "    - fallback:\n        - wrong: raises\n        - count: {up_to: 3, count: $n}\n"
    )
    record = tmp_path / "record"
    assert momantu_bt.run(file, world="none", record=record).status == "SUCCESS"
    Count.events.clear()
    assert main(["replay", str(record), "--check"]) == 0
    assert Count.events == []


@pytest.mark.parametrize(
    ("plugin", "said"),
    [
        (5, "is not a py_trees Behaviour class"),
        (behaviour(Count, failure="no code"), "is not a failure code"),
        (behaviour(Count, input_port("far", int, " ")), "has no doc"),
        (behaviour(Count, codes=("NO_WAY", "no way")), "'no way' is not a failure code"),
        (py_trees.behaviours.Periodic, "missing a required argument: 'n'"),
        (behaviour(py_trees.behaviours.Periodic, UP_TO, through="constructor"), "argument: 'n'"),
        (Endless, "Endless has no update"),
    ],
)
def test_a_broken_one_is_told(tree, capsys, plugin, said):
    INSTALLED["count"] = plugin
    assert main(["check", str(tree("    - count:\n"))]) != 0
    told = "".join(capsys.readouterr())
    assert "the behaviour 'count'" in told
    assert said in told


# a tree file as a behaviour


def ticked(root: py_trees.behaviour.Behaviour, most: int = 50) -> list[Status]:
    found = []
    while len(found) < most and (not found or found[-1] is Status.RUNNING):
        root.tick_once()
        found.append(root.status)
    return found


def test_a_tick_of_it_is_a_tick_of_the_tree(tree):
    enter = momantu_bt.as_behaviour(tree("    - wait: 0.2 s\n    - set: {key: $a, value: 1}\n"))
    assert enter.name == "Main"
    assert ticked(enter) == [Status.RUNNING] * 4 + [Status.SUCCESS]
    assert enter.values == {"a": 1}
    assert "wait" in py_trees.display.ascii_tree(enter.shown())


def test_it_starts_anew_after_its_end(tree):
    enter = momantu_bt.as_behaviour(tree("    - wait: 0.1 s\n"))
    assert ticked(enter) == ticked(enter) == [Status.RUNNING] * 2 + [Status.SUCCESS]


def test_why_it_fails_is_its_feedback(tree):
    enter = momantu_bt.as_behaviour(tree("    - fail: {code: NO_WAY, message: walls all around}\n"))
    assert ticked(enter) == [Status.FAILURE]
    assert enter.feedback_message == "NO_WAY, walls all around"


def test_an_interruption_halts_it(tree):
    text = "    - {wait: 10 s, on_halt: $halted = 1}\n"
    enter = momantu_bt.as_behaviour(tree(f"    - set: {{key: $halted, value: 0}}\n{text}"))
    alarm = py_trees.behaviours.StatusQueue(
        "alarm", queue=[Status.FAILURE, Status.FAILURE, Status.SUCCESS], eventually=Status.SUCCESS
    )
    root = py_trees.composites.Selector("root", memory=False, children=[alarm, enter])
    assert ticked(root) == [Status.RUNNING, Status.RUNNING, Status.SUCCESS]
    assert enter.status is Status.INVALID
    assert enter.values == {"halted": 1}


def test_its_feedback_is_what_runs_now(tree):
    enter = momantu_bt.as_behaviour(tree("    - wait: 0.1 s\n    - wait: 0.2 s\n    - succeed\n"))
    for _ in range(2):
        said = []
        while not said or enter.status is Status.RUNNING:
            enter.tick_once()
            said.append(enter.feedback_message)
        assert said == ["wait 0.1 s"] * 2 + ["wait 0.2 s"] * 4 + [""]


def test_a_shutdown_halts_what_runs(tree):
    text = "    - {wait: 10 s, on_halt: $halted = 1}\n"
    enter = momantu_bt.as_behaviour(tree(f"    - set: {{key: $halted, value: 0}}\n{text}"))
    enter.tick_once()
    enter.shutdown()
    assert enter.status is Status.INVALID
    assert enter.values == {"halted": 1}


def test_what_a_tick_raises_halts_the_tree_first(tree, monkeypatch):
    text = "    - {wait: 10 s, on_halt: $halted = 1}\n"
    enter = momantu_bt.as_behaviour(tree(f"    - set: {{key: $halted, value: 0}}\n{text}"))
    enter.tick_once()

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Executor, "_note", interrupted)
    with pytest.raises(KeyboardInterrupt):
        enter.tick_once()
    assert enter.values == {"halted": 1}


def test_mistakes_are_raised_where_it_is_made(tree):
    with pytest.raises(TreeError):
        momantu_bt.as_behaviour(tree("    - wat: 1\n"))


def test_with_a_world_skills_run_and_each_tick_steps_the_world(tree):
    class Drive(momantu_bt.Skill):
        """Drives a while."""

        def run(self, robot):
            for _ in range(3):
                yield "driving"

    world = ScriptedWorld()
    enter = momantu_bt.as_behaviour(
        tree("    - drive\n"), world=world, registry=Registry(skills={"drive": Drive})
    )
    before = world.now()
    assert ticked(enter) == [Status.RUNNING] * 3 + [Status.SUCCESS]
    assert world.now() == pytest.approx(before + 4 * 0.05)


def test_the_page_is_right(tmp_path, monkeypatch, capsys):
    files = dict(FILE.findall(PAGE.read_text(encoding="utf-8")))
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path / "src")
    INSTALLED["open_door"] = runpy.run_path("src/door/door.py")["OPEN_DOOR"]
    install(monkeypatch, "open_door")
    assert main(["check", "tree.yaml"]) == 0
    capsys.readouterr()
    page = runpy.run_path("mounted.py")
    assert capsys.readouterr().out == "Status.SUCCESS 1.5\n"
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    exec(blocks[-1], page)
    assert "open_door" in capsys.readouterr().out
