"""Tunables: what a site sets of them, what is refused in which words, and how they are told."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import Field, ValidationError

from momantu_bt import plugins
from momantu_bt.descriptions.quantities import Angle, LinearSpeed, Size
from momantu_bt.descriptions.reading import DescriptionError, Reading
from momantu_bt.descriptions.tunables import (
    TUNABLES,
    Tunable,
    Tunables,
    configured,
    groups_of,
    tunable_problems,
    tunables_of,
)


class Lamp(Tunables):
    """A lamp on the robot."""

    power: float = Field(default=5.0, ge=0.0, le=10.0, description="of its light")


class Patrol(Tunables):
    """How the robot patrols."""

    speed: LinearSpeed = Field(default=0.5, le=2.0, description="between two places")
    rounds: int = Field(default=3, ge=1, description="before it stops")
    gap: tuple[Size, Angle] = Field(default=(0.1, 0.2), description="to the next place")
    share: Annotated[float, Field(ge=0.0, lt=1.0)] = Field(default=0.5, gt=0.1, description="of it")
    lamp: Lamp = Lamp()


def test_what_a_site_does_not_set_stays_as_declared() -> None:
    set_here = configured(Patrol, {"speed": "30 cm/s", "lamp": {"power": 7}}, "patrol")
    assert set_here.model_dump() == {**Patrol().model_dump(), "speed": 0.3, "lamp": {"power": 7.0}}


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"sped": 1.0}, "patrol has no tunable 'sped'; did you mean speed?"),
        ({"lamp": {"powr": 1}}, "patrol.lamp has no tunable 'powr'; did you mean power?"),
        ({"xyz": 1}, "patrol has no tunable 'xyz'; tunables: speed, rounds, gap, share, lamp"),
        ({"speed": "1 m"}, "patrol.speed: '1 m' is a length; expected a speed, in: m/s, cm/s"),
        ({"speed": 3}, "patrol.speed: expected to be less than or equal to 2"),
        ({"lamp": {"power": -1}}, "patrol.lamp.power: expected to be greater than or equal to 0"),
        ({"rounds": 0, "share": 1}, "patrol.rounds: expected to be greater than or equal to 1; "
         "patrol.share: expected to be less than 1"),
    ],
)  # fmt: skip
def test_what_cannot_be_set_is_told_with_its_name(parameters: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match="patrol") as caught:
        configured(Patrol, parameters, "patrol")
    assert str(caught.value) == said


def test_they_do_not_change() -> None:
    with pytest.raises(ValidationError):
        Patrol().speed = 1.0


def test_each_is_told_with_unit_default_range_and_meaning() -> None:
    assert list(tunables_of(Patrol)) == [
        Tunable("speed", "m/s", "0.5", "above 0, at most 2", "between two places"),
        Tunable("rounds", "", "3", "at least 1", "before it stops"),
        Tunable("gap", "m, rad", "0.1, 0.2", "above 0", "to the next place"),
        Tunable("share", "", "0.5", "above 0.1, below 1", "of it"),
    ]
    assert list(groups_of(Patrol)) == [("lamp", Lamp)]


@pytest.mark.parametrize(
    ("services", "line", "said"),
    [
        ("    odd: {speed: 3}", 3, "the service 'odd' declares no tunables"),
        ("    patroll: {speed: 3}", 3, "no service or skill 'patroll' has tunables; did you mean"),
        ("    patrol:\n      sped: 3", 4, "did you mean"),
        ("    patrol:\n      speed: 3 kg", 4, "'3 kg' is a mass"),
    ],
)
def test_a_file_that_sets_a_service_wrongly(
    monkeypatch: pytest.MonkeyPatch, services: str, line: int, said: str
) -> None:
    entries = {
        "momantu_bt.services": [EntryPoint("odd", "a:B", "momantu_bt.services")],
        TUNABLES.name: [EntryPoint("patrol", f"{__name__}:Patrol", TUNABLES.name)],
    }
    monkeypatch.setattr(plugins, "entry_points", lambda group: entries.get(group, []))
    monkeypatch.setattr(EntryPoint, "load", lambda entry: Patrol)
    text = f"site:\n  services:\n{services}\n"
    reading = Reading(Path("w.yaml"), text, DescriptionError)
    (problem,) = tunable_problems(reading, ("site", "services"))
    assert problem.place.line == line
    assert said in problem.message + str(DescriptionError(Path("w.yaml"), text, [problem]))
