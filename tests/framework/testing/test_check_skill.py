"""A right skill has no findings; one that breaks a rule has findings of that rule alone."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.skill import Skill
from momantu_bt.testing import assert_skill, check_skill

RIGHT = '''
"""A right skill, and the lines that the tests replace."""
import random
import time
from datetime import datetime
from typing import Any

import numpy as np

from momantu_bt import Failure, In, Needs, Out, Robot, Run, Skill
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import read_laser

# module


class Advance(Skill):
    """Drive straight ahead until the distance is covered."""

    distance: float = In(0.05, unit="m", doc="how far, by odometry")
    clearance: float = In(unit="m", doc="the least distance to anything the laser sees")
    covered: float = Out(unit="m", doc="how far it went")
    failures = {"BLOCKED": "something came closer than the clearance"}
    uses = {"base"}
    # class

    def run(self, robot: Robot) -> Run:
        """Command the base every tick until odometry says that it is there."""
        start = robot.state().odom_from_base
        self._began = self.clock.now()
        # begin
        try:
            while True:
                # loop
                moved = start.inverse() @ robot.state().odom_from_base
                self.covered = float(moved.position[0])
                if self.covered >= self.distance:
                    return
                nearest = float(read_laser(robot).ranges.min())
                if nearest < self.clearance:
                    raise Failure("BLOCKED", f"something is {nearest:.2f} m away")
                robot.command("base", BaseVelocity(0.2 + 0.01 * self.random.random(), 0.0))
                yield "driving"
        finally:
            pass  # end
'''

LOOK = """def _look(self, robot):
        try:
            return float(read_laser(robot).ranges.min())
        except Failure:
            return None
"""
HALTED = "__import__('sys').exc_info()[0] is GeneratorExit"

BREAKS: dict[str, tuple[str, dict[str, str]]] = {
    "no docstring": ("docs", {'"""Drive straight ahead until the distance is covered."""': ""}),
    "a port without doc": ("docs", {'doc="how far it went"': 'doc=""'}),
    "a code in a word": ("docs", {'"something came closer than the clearance"': '"blocked"'}),
    "reads what is no port": ("undeclared-port", {"# begin": "self.speed if start is None else 0"}),
    "writes what is no port": ("undeclared-port", {"# begin": "self.speed = 3.0"}),
    "writes its input": ("input-written", {"# begin": "self.distance = 0.1"}),
    "an output no line gives": (
        "output-never-given",
        {"self.covered": "covered", "uses =": 'covered: float = Out(doc="it")\n    uses ='},
    ),
    "an output that some path leaves out": (
        "output-never-given",
        {"# class": 'beside: float = Out(doc="it")', "# begin": "if not robot: self.beside = 1.0"},
    ),
    "an input no line reads": ("input-never-read", {"# class": 'speed: int = In(1, doc="it")'}),
    "an output of another type": (
        "wrong-type",
        {"float(moved.position[0])": '"far"', ">= self.distance": "and self.distance"},
    ),
    "an undeclared code, in the source": (
        "undeclared-code",
        {"# begin": 'if start is None: raise Failure("LOST", "it is lost")'},
    ),
    "an undeclared code, at work": (
        "undeclared-code",
        {"# begin": 'raise Failure("LO" + "ST", "it is lost")'},
    ),
    "an undeclared actuator": ("undeclared-actuator", {'uses = {"base"}': 'uses = {"arm"}'}),
    "an exception": ("exception", {"# loop": "{}[self.covered] if self.clock.now() > 0.2 else 0"}),
    "an exception when a sensor is dead": (
        "exception",
        {
            "nearest = float(read_laser(robot).ranges.min())": "nearest = self._look(robot)",
            "# class": LOOK,
        },
    ),
    "exits": ("escapes", {"# begin": "raise SystemExit(1)"}),
    "no generator": ("exception", {'yield "driving"': "pass", "while True": "if True"}),
    "time.time": ("wall-clock", {"# begin": "time.time()"}),
    "time.sleep": ("wall-clock", {"# begin": "time.sleep(0.0)"}),
    "datetime": ("wall-clock", {"# begin": "datetime.now()"}),
    "a clock by another name": ("wall-clock", {"# begin": "getattr(time, 'mono' + 'tonic')()"}),
    "a clock in a branch": ("wall-clock", {"# begin": "if start is None: time.perf_counter()"}),
    "a date by another name": ("wall-clock", {"# begin": "getattr(datetime, 'no' + 'w')()"}),
    "random": ("unseeded-random", {"# begin": "random.random() if start is None else 0"}),
    "a generator without seed": (
        "unseeded-random",
        {"# begin": "np.random.default_rng() if start is None else 0"},
    ),
    "random by another name": (
        "unseeded-random",
        {"# begin": "getattr(random, 'unif' + 'orm')(0, 1)"},
    ),
    "numpy's by another name": (
        "unseeded-random",
        {"# begin": "getattr(np.random, 'ra' + 'nd')()"},
    ),
    "different each time": (
        "not-deterministic",
        {
            "# module": "RUNS = []",
            "# begin": "RUNS.append(1)",
            "0.2 +": "0.1 * min(3, len(RUNS)) +",
        },
    ),
    "outputs that differ": (
        "not-deterministic",
        {
            "# module": "RUNS = []",
            "# begin": "RUNS.append(1)",
            "# class": 'runs: int = Out(doc="how many")',
            "return\n": "self.runs = len(RUNS)\n                    return\n",
        },
    ),
    "yields when it is halted": ("halt", {"pass  # end": "yield 'ending'"}),
    "raises when it is halted": ("halt", {"pass  # end": f"{{}}[0] if {HALTED} else 0"}),
    "leaves the base moving": (
        "halt",
        {
            "import BaseVelocity": "import BaseVelocity, JointPositions",
            "pass  # end": "robot._robot.command('head', JointPositions(('pan',), (0.5,)))",
        },
    ),
    "commands after its end": (
        "halt",
        {
            "# begin": "advance = robot._robot.advance\n        robot._robot.advance = lambda s: "
            "(advance(s), robot._robot.stop('base'))[0]"
        },
    ),
    "cannot be started again": (
        "restart",
        {
            "# module": "HELD = []",
            "# begin": "if HELD: raise Failure('BLOCKED', 'it is held')\n        HELD.append(1)",
            "return\n": "HELD.clear()\n                    return\n",
        },
    ),
    "a service that is not installed": ("not-rehearsed", {"# class": "oracle: Any = Needs()"}),
    "an input of an unknown type": (
        "not-rehearsed",
        {
            "# module": "class Odd: pass",
            "# class": 'odd: Odd = In(doc="it")',
            "# begin": "self.odd",
        },
    ),
}
"""What is wrong, the rule that it breaks, and the lines of the right skill that make it so."""


@pytest.fixture
def skill(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., type[Skill]]]:
    """`skill(lines)`: the right skill with some of its lines replaced, from a module of its own."""
    monkeypatch.syspath_prepend(tmp_path)
    names: list[str] = []

    def build(replaced: dict[str, str]) -> type[Skill]:
        text = RIGHT
        for old, new in replaced.items():
            assert old in text
            text = text.replace(old, new)
        names.append(f"checked_skill_{len(names)}_of_{tmp_path.name}")
        (tmp_path / f"{names[-1]}.py").write_text(text, encoding="utf-8")
        found: type[Skill] = importlib.import_module(names[-1]).Advance
        return found

    yield build
    for name in names:
        sys.modules.pop(name, None)


def rules(findings: list[Problem]) -> set[str]:
    return {finding.code for finding in findings if finding.severity is not Severity.HINT}


def test_a_right_skill_has_no_findings(skill: Callable[..., type[Skill]]) -> None:
    assert check_skill(skill({})) == []
    assert_skill(skill({}))


@pytest.mark.parametrize("wrong", BREAKS)
def test_each_rule_finds_what_breaks_it_and_nothing_else(
    skill: Callable[..., type[Skill]], wrong: str
) -> None:
    rule, lines = BREAKS[wrong]
    broken = skill(lines)
    found = check_skill(broken, halts=3)
    assert rules(found) == {rule}, found
    with pytest.raises(AssertionError, match=rule):
        assert_skill(skill(lines), halts=3)


def test_a_finding_names_its_line(skill: Callable[..., type[Skill]]) -> None:
    broken = skill({"# begin": "time.time()"})
    (finding,) = check_skill(broken, halts=1)
    lines = Path(finding.place.file).read_text(encoding="utf-8").splitlines()
    assert lines[finding.place.line - 1].strip() == "time.time()"


def test_an_example_gives_what_cannot_be_made(skill: Callable[..., type[Skill]]) -> None:
    kind = skill(BREAKS["an input of an unknown type"][1])
    odd = sys.modules[kind.__module__].Odd
    assert check_skill(kind, lambda seed: {"inputs": {"odd": odd()}}, halts=2) == []
    kind.rehearsal = classmethod(lambda cls, seed: {"inputs": {"odd": odd()}})  # type: ignore
    assert check_skill(kind, halts=2) == []
    needy = skill(BREAKS["a service that is not installed"][1])
    assert check_skill(needy, lambda seed: {"services": {"oracle": object()}}, halts=2) == []


def test_a_failure_at_once_is_noted_and_is_no_fault(skill: Callable[..., type[Skill]]) -> None:
    kind = skill({"nearest < self.clearance": "nearest > self.clearance"})
    (note,) = check_skill(kind)
    assert note.severity is Severity.HINT
    assert "BLOCKED" in str(note)
    assert_skill(kind)


def test_it_is_halted_at_every_tick(skill: Callable[..., type[Skill]]) -> None:
    """One that minds being halted in one tick only is found out."""
    late = "0.19 < self.clock.now() - self._began < 0.21"
    kind = skill({"pass  # end": f"{{}}[0] if {late} and {HALTED} else 0"})
    assert rules(check_skill(kind)) == {"halt"}


def test_modules_that_it_imports_are_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "checked_package"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "deep.py").write_text(
        "from time import time as now\n\n\ndef when():\n    return now()\n"
    )
    (package / "near.py").write_text("def when():\n    from . import deep\n    return 0\n")
    (package / "unused.py").write_text("import time\n\ntime.time()\n")
    text = RIGHT.replace("# begin", "from checked_package import near\n        near.when()")
    (package / "skill.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    kind = importlib.import_module("checked_package.skill").Advance
    (finding,) = check_skill(kind, halts=1)
    assert finding.code == "wall-clock"
    assert finding.place == Place(str(package / "deep.py"), 5)


def test_a_skill_that_calls_another_is_rehearsed_with_it(
    skill: Callable[..., type[Skill]],
) -> None:
    lines = {
        "# begin": 'yield from self.call("reset_pose", pose="home")',
        'uses = {"base"}': 'uses = {"base", "arm", "head"}; calls = ("reset_pose",)',
    }
    assert check_skill(skill(lines), halts=2) == []
    undeclared = {**lines, 'calls = ("reset_pose",)': "pass"}
    assert "undeclared-call" in rules(check_skill(skill(undeclared), halts=2))
    idle = {**lines, "# begin": 'self.call("reset_pose", pose="home")'}
    assert rules(check_skill(skill(idle), halts=2)) == {"call-not-run"}
    unused = {**lines, 'uses = {"base", "arm", "head"}': 'uses = {"base"}'}
    assert rules(check_skill(skill(unused), halts=2)) == {"undeclared-actuator"}


BASE = """
from momantu_bt import Failure, In, Out, Robot, Run, Skill
from momantu_bt.messages import BaseVelocity

from base_package_{n}.helper import least


class Rolling(Skill):
    \"\"\"Roll ahead.\"\"\"

    distance: float = In(0.2, unit="m", doc="how far to go")
    clearance: float = In(0.0, unit="m", doc="what stays free")
    covered: float = Out(unit="m", doc="how far it went")
    failures = {{"BLOCKED": "something is in the way", "TOO_FAR": "it is too far to go"}}
    uses = {{"base"}}

    def __init__(self):
        super().__init__()
        self._began = 0.0

    def run(self, robot: Robot) -> Run:
        self._check()
        self._began = self.clock.now()
        start = robot.state().odom_from_base
        while self._moved(robot, start) < least(self):
            robot.command("base", BaseVelocity(0.2, 0.0))
            yield "rolling"
        self.covered = self._moved(robot, start)

    def _check(self):
        if self.distance > 3.0:
            raise Failure("TOO_FAR", "that is too far")

    def _moved(self, robot, start):
        return float((start.inverse() @ robot.state().odom_from_base).position[0])


class Counting:
    def count(self):
        self._count = 1
        return self._count
"""
HELPER = """
def least(skill):
    return skill.distance - skill.clearance
"""
SUB = """
from momantu_bt import Failure, In, Out
from base_package_{n}.rolling import Counting, Rolling


class Other(Rolling, Counting):
    \"\"\"Roll ahead, as another package has it.\"\"\"

    extra: float = In(0.0, unit="m", doc="how much farther to go")
    failures = {{"BLOCKED": "something is in the way"}}

    def _check(self):
        self.count()
        if self._count and self.extra > 1.0:
            raise Failure("BLOCKED", "that is too much")
"""


@pytest.fixture
def subclass(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[dict[str, str]], type[Skill]]]:
    """`subclass(lines)`: a skill whose base class stands in another package."""
    monkeypatch.syspath_prepend(tmp_path)

    def build(replaced: dict[str, str]) -> type[Skill]:
        number = len(list(tmp_path.iterdir())) + sum(map(ord, tmp_path.name))
        package = tmp_path / f"base_package_{number}"
        package.mkdir()
        texts = {"__init__": "", "helper": HELPER, "rolling": BASE.format(n=number)}
        for name, text in texts.items():
            (package / f"{name}.py").write_text(text, encoding="utf-8")
        text = SUB.format(n=number)
        for old, new in replaced.items():
            assert old in text
            text = text.replace(old, new)
        (tmp_path / f"sub_module_{number}.py").write_text(text, encoding="utf-8")
        importlib.invalidate_caches()
        found: type[Skill] = importlib.import_module(f"sub_module_{number}").Other
        return found

    before = set(sys.modules)
    yield build
    for name in set(sys.modules) - before:
        if name.startswith(("base_package_", "sub_module_")):
            del sys.modules[name]


def test_what_a_base_class_in_another_package_does_counts(
    subclass: Callable[[dict[str, str]], type[Skill]],
) -> None:
    """Its ports are read and given there, and a method that is replaced raises nothing."""
    assert check_skill(subclass({}), halts=3) == []


@pytest.mark.parametrize(
    ("lines", "rule"),
    [
        ({"extra > 1.0": "extra > 1.0 and self._other"}, "undeclared-port"),
        ({"self.count()": "self.count(); super()._check()"}, "undeclared-code"),
        (
            {"    def _check(self):": "    def _check(self):\n        import time; time.time()"},
            "wall-clock",
        ),
    ],
)
def test_a_subclass_is_still_checked(
    subclass: Callable[[dict[str, str]], type[Skill]], lines: dict[str, str], rule: str
) -> None:
    found = rules(check_skill(subclass(lines), halts=3))
    assert found == {rule}


def test_the_clock_of_a_base_class_is_found(
    subclass: Callable[[dict[str, str]], type[Skill]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(
        globals(),
        "HELPER",
        HELPER.replace("    return", "    import time; time.time()\n    return"),
    )
    assert rules(check_skill(subclass({}), halts=2)) == {"wall-clock"}
