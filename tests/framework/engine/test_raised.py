"""Exceptions of plug-ins: what is told of them, and at which line of theirs they happened."""

from __future__ import annotations

import linecache
import sys

import pytest

from momantu_bt.engine.raised import raised_at
from momantu_bt.failure import Failure
from momantu_bt.record.text.ending import ending_text
from momantu_bt.service import Service
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import ScriptedWorld

HERE = "test_raised.py"


class Crash(Skill):
    """Divides by nothing."""

    def run(self, robot) -> Run:
        yield "thinking"
        raise ZeroDivisionError("by nothing")


class Undeclared(Skill):
    """Raises a code that it does not declare."""

    def run(self, robot) -> Run:
        yield "thinking"
        raise Failure("OOPS", "it slipped")


@pytest.mark.parametrize(
    ("skill", "said", "line"),
    [
        (Crash, "raised ZeroDivisionError: by nothing", 'raise ZeroDivisionError("by nothing")'),
        (
            Undeclared,
            "raised OOPS, which it does not declare",
            'raise Failure("OOPS", "it slipped")',
        ),
    ],
)
def test_a_skill_that_crashes_shows_its_line(run_yaml, skill, said, line):
    report = run_yaml(f"trees: {{Main: {skill.__name__.lower()}}}", skill)
    assert report.failure.code == "SKILL_ERROR"
    told = ending_text(report)
    assert said in told
    number = next(n for n, text in enumerate(linecache.getlines(__file__), 1) if line in text)
    assert f"{HERE}:{number}: {line}" in told


@pytest.mark.parametrize("method", ["start", "update", "published"])
def test_a_service_that_crashes_is_named_with_its_line(run_yaml, method):
    class Battery(Service):
        """Fails in one of its methods."""

        publishes = {"charge": float}

        def fail(self, where):
            if where == method:
                raise KeyError(where)

        def start(self, context):
            self.fail("start")

        def update(self, robot, now):
            self.fail("update")

        def published(self):
            self.fail("published")
            return {"charge": 1.0}

    world = ScriptedWorld()
    tree = "trees: {Main: [{wait: 0.2 s}, {condition: $@battery.charge > 0}]}"
    report = run_yaml(tree, services={"battery": Battery}, world=world)
    assert report.status == "ERROR"
    assert f"Battery.{method} raised KeyError: '{method}', at " in ending_text(report)
    assert "raise KeyError(where)" in ending_text(report)
    assert report.error.startswith("Traceback")


def test_what_a_service_publishes_may_be_a_failure(run_yaml):
    class Battery(Service):
        """Its gauge is broken."""

        publishes = {"charge": float}

        def start(self, context):
            pass

        def update(self, robot, now):
            pass

        def published(self):
            raise Failure("SENSOR_DEAD", "the gauge is broken")

    tree = "trees: {Main: [{condition: $@battery.charge > 0}]}"
    report = run_yaml(tree, services={"battery": Battery}, world=ScriptedWorld())
    assert (report.status, report.failure.code) == ("FAILURE", "SENSOR_DEAD")


def _raised(function):
    try:
        function()
    except Exception as error:
        return error
    raise AssertionError


def test_the_file_is_told_from_its_package_on(tmp_path, monkeypatch):
    folder = tmp_path / "nodding"
    (folder / "deep").mkdir(parents=True)
    (folder / "__init__.py").write_text("def first(then):\n    then()\n")
    (folder / "deep" / "__init__.py").write_text(
        "def inner():\n    import json\n    json.loads('')\n"
    )
    (folder / "alone.py").write_text("def last():\n    raise OSError\n")
    monkeypatch.syspath_prepend(tmp_path)
    import nodding
    from nodding import alone, deep

    error = _raised(lambda: nodding.first(deep.inner))
    assert raised_at(error, "nodding.other") == "nodding/deep/__init__.py:3: json.loads('')"
    assert raised_at(error, "numpy") == ""
    error = _raised(lambda: nodding.first(alone.last))
    assert raised_at(error, "nodding") == "nodding/alone.py:2: raise OSError"
    for name in [name for name in sys.modules if name.partition(".")[0] == "nodding"]:
        del sys.modules[name]


def test_an_exception_that_was_never_raised_has_no_place():
    assert raised_at(ValueError("x"), __name__) == ""
