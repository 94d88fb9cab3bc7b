"""The rules for all services: each is broken once; the service of the page keeps them."""

from __future__ import annotations

import importlib
import json
import random
import re
import sys
import time
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

import momantu_bt.tree.plugins
from momantu_bt import plugins
from momantu_bt.cli import main
from momantu_bt.engine.skills.services import ServiceError
from momantu_bt.failure import Failure
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import read_laser
from momantu_bt.scaffold import new_service
from momantu_bt.service import Service
from momantu_bt.testing import ExampleWorld, assert_service, check_service
from momantu_bt.tree.plugins import SERVICES

PAGE = Path(__file__).resolve().parents[3] / "docs" / "writing_a_service.md"


class Fine(Service):
    """Counts, draws and measures."""

    rate = 10.0
    publishes = {"count": int, "drawn": float}

    def start(self, context: Any) -> None:
        self.count, self.random, self.drawn = 0, context.random, 0.0

    def update(self, robot: Any, now: float) -> None:
        self.count += 1
        self.drawn = float(self.random.random())

    def published(self) -> Any:
        return {"count": self.count, "drawn": self.drawn}


class Slow(Fine):
    """Reads the computer's clock."""

    def update(self, robot: Any, now: float) -> None:
        super().update(robot, now)
        self.drawn = time.time()


class Hasty(Fine):
    """Wants more updates than there are ticks."""

    rate = 50.0


class Random(Fine):
    """Draws from a generator that all share."""

    def update(self, robot: Any, now: float) -> None:
        super().update(robot, now)
        self.drawn = random.random()


class Meddling(Fine):
    """Drives off."""

    def update(self, robot: Any, now: float) -> None:
        robot.command("base", BaseVelocity(1.0, 0.0))


class Silent(Fine):
    """Forgets a key and invents another."""

    def published(self) -> Any:
        return {"count": self.count, "drwn": 0.5}


class Wrong(Fine):
    """Publishes a text for a number."""

    def published(self) -> Any:
        return {"count": "three", "drawn": 0.5}


class Restless(Fine):
    """Counts when it is asked."""

    def published(self) -> Any:
        self.count += 1
        return {"count": self.count, "drawn": 0.5}


class Blind(Fine):
    """Cannot do without its laser."""

    def update(self, robot: Any, now: float) -> None:
        read_laser(robot)


class Broken(Fine):
    """Divides by nothing."""

    def update(self, robot: Any, now: float) -> None:
        raise ZeroDivisionError("by nothing")


class Lonely(Fine):
    """Needs what is not installed."""

    needs = ("no_such_service",)


class Backward(Fine):
    """Has no rate."""

    rate = 0.0


class Patient(Fine):
    """Its gauge does not answer at first, which it says to who reads it."""

    def published(self) -> Any:
        if self.count < 5:
            raise Failure("SENSOR_DEAD", "the gauge does not answer yet")
        return super().published()


@pytest.mark.parametrize(
    ("kind", "codes"),
    [
        (Fine, set()),
        (Patient, set()),
        (Slow, {"wall-clock", "not-deterministic"}),
        (Hasty, {"rate"}),
        (Random, {"unseeded-random", "not-deterministic"}),
        (Meddling, {"commands"}),
        (Silent, {"undeclared-key", "key-never-given"}),
        (Wrong, {"wrong-type"}),
        (Restless, {"published-changes"}),
        (Blind, {"exception"}),
        (Broken, {"exception"}),
        (Lonely, {"not-rehearsed"}),
        (Backward, {"docs"}),
    ],
)
def test_each_rule_is_found(kind: type[Service], codes: set[str]) -> None:
    found = check_service(kind)
    only = {"wall-clock", "unseeded-random"}  # they stand in this file, which all of them share
    assert {each.code for each in found} - (only - codes) == codes, found
    if codes - only:
        with pytest.raises(AssertionError, match=kind.__name__):
            assert_service(kind)


@pytest.mark.parametrize("name", SERVICES)
def test_the_services_of_the_package_keep_the_rules(name: str) -> None:
    assert_service(SERVICES.load(name), name=name)


class NoUpdate(Service):
    """Has no update."""

    def start(self, context: Any) -> None: ...


class Bare(Fine):
    """Publishes without a method for it."""

    published = Service.published


class Typeless(Fine):
    """Publishes something that is no type."""

    publishes = {"count": "many"}  # type: ignore[dict-item]


class Needy(Fine):
    """Its needs are a text."""

    needs = "localization"  # type: ignore[assignment]


@pytest.mark.parametrize(
    ("name", "plugin", "said"),
    [
        ("fine", Fine, None),
        ("robot", Fine, "a key that every run publishes"),
        ("two words", Fine, "is not a name for a service"),
        ("fine", "text", "str is not a subclass of momantu_bt.Service"),
        ("fine", NoUpdate, "NoUpdate has no update"),
        ("fine", Bare, "has no published()"),
        ("fine", Typeless, "'many' of 'count' is not a type"),
        ("fine", Needy, "expected a tuple of names"),
        ("fine", Backward, "rate is 0.0; expected"),
    ],
)
def test_a_wrong_service_is_refused_when_it_is_loaded(name: str, plugin: Any, said: str) -> None:
    objection = momantu_bt.tree.plugins.service_objection(name, plugin)
    assert (objection is None) if said is None else (said in str(objection))


# The page.


@pytest.fixture
def battery(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The service of the page, in a package that `services new` writes."""
    monkeypatch.syspath_prepend(new_service("battery", tmp_path) / "src")
    yield importlib.import_module("battery_service.battery").Battery
    for name in [name for name in sys.modules if name.startswith("battery_service")]:
        del sys.modules[name]


def page_tree() -> str:
    return re.findall(r"```yaml\n(momantu_bt.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[0]


def test_the_page_shows_what_services_new_writes(tmp_path: Path) -> None:
    folder = new_service("battery", tmp_path)
    written = (folder / "src/battery_service/battery.py").read_text("utf-8")
    assert f"```python\n{written}```" in PAGE.read_text("utf-8")
    project = (folder / "pyproject.toml").read_text("utf-8")
    (toml,) = re.findall(r"```toml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert all(line in project for line in toml.splitlines())


def test_the_service_of_the_page_keeps_the_rules(battery: Any) -> None:
    assert_service(battery, name="battery", parameters={"charge": 0.5})


@pytest.mark.parametrize(("idle", "low"), [(0.1, True), (0.0001, False)])
def test_the_guard_of_the_page_ends_the_long_step(
    run_tree: Any, battery: Any, idle: float, low: bool
) -> None:
    kind = type("Battery", (battery,), {})
    world = ExampleWorld()
    object.__setattr__(world.site, "services", {"battery": {"idle": idle}})
    report = run_tree(page_tree(), services={"battery": kind}, world=world, max_time=90.0)
    world.close()
    assert report.status == "SUCCESS", report.failure
    assert (report.sim_time_s < 15.0) is low


def test_wrong_parameters_are_told_with_the_line_of_the_service(battery: Any) -> None:
    (finding,) = check_service(battery, name="battery", parameters={"chrge": 1})
    assert "battery has no tunable 'chrge'; did you mean charge?" in finding.message
    assert isinstance(finding.message, str)
    assert ServiceError.exit_code == 4


# The verbs.


def test_services_are_listed_shown_and_tested(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["services", "--json"]) == 0
    assert [row["name"] for row in json.loads(capsys.readouterr().out)] == list(SERVICES)
    name = next(iter(SERVICES))
    assert main(["services", "show", name]) == 0
    text = capsys.readouterr().out
    assert all(f"$@{name}.{key}" in text for key in SERVICES.load(name).publishes)
    assert main(["services", "show", name, "--json"]) == 0
    about = json.loads(capsys.readouterr().out)
    assert set(about["publishes"]) == set(SERVICES.load(name).publishes)
    assert about["tunables"]
    assert main(["services", "test", name]) == 0
    assert capsys.readouterr().out == f"ok    {name}\n"
    assert main(["services", "show", name[:-1]]) == 2
    assert f"did you mean {name!r}?" in capsys.readouterr().err


def test_a_broken_service_does_not_pass(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    entry = EntryPoint("odd", "json:loads", SERVICES.name)
    monkeypatch.setattr(plugins, "entry_points", lambda group: [entry])
    assert main(["services", "test"]) == 1
    assert "is not a subclass of momantu_bt.Service" in capsys.readouterr().out
    assert main(["services", "list"]) == 1


@pytest.mark.parametrize(
    ("name", "reason"),
    [("robot", "every run publishes"), ("two words", "letters"), ("localization", "installed")],
)
def test_a_bad_name_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, reason: str
) -> None:
    assert main(["services", "new", name, "--into", str(tmp_path)]) == 2
    assert reason in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
