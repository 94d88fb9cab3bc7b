"""Errors carry their exit code, and the command line prints them in one way."""

from __future__ import annotations

from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.cli.verbs import COMMANDS
from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.errors import ExitCode, InputError, MomantuError
from momantu_bt.formats.files import OutputError
from momantu_bt.plugins import PluginError
from momantu_bt.robots.errors import RobotFileError, RobotNotInstalled
from momantu_bt.running.options import RunOptions
from momantu_bt.testing import ScriptedWorld
from momantu_bt.world import WorldError


def test_a_hint_stands_in_a_line_of_its_own() -> None:
    error = InputError("--speed 7: at most 1.5 m/s", hint="the limit is the robot's")
    assert error.printed() == "momantu-bt: --speed 7: at most 1.5 m/s\nthe limit is the robot's"
    assert InputError("no").printed() == "momantu-bt: no"


@pytest.mark.parametrize(
    ("kind", "code"),
    [
        (WorldError, ExitCode.NO_WORLD),
        (RobotNotInstalled, ExitCode.NO_WORLD),
        (DescriptionError, ExitCode.WRONG_INPUT),
        (RobotFileError, ExitCode.WRONG_INPUT),
        (PluginError, ExitCode.WRONG_INPUT),
        (OutputError, ExitCode.WRONG_INPUT),
    ],
)
def test_exit_codes(kind: type[MomantuError], code: ExitCode) -> None:
    assert kind.exit_code is code
    assert issubclass(RobotFileError, WorldError) is False


def test_what_a_verb_of_a_plug_in_raises_is_told_with_its_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Tired(MomantuError):
        exit_code = ExitCode.FAILURE

    def nap() -> None:
        """Rest."""
        raise Tired("it sleeps", hint="try again tomorrow")

    monkeypatch.setattr(COMMANDS, "installed", lambda: {"nap": None})
    monkeypatch.setattr(COMMANDS, "load", lambda name: nap)
    assert main(["nap"]) == ExitCode.FAILURE
    assert capsys.readouterr().err == "momantu-bt: it sleeps\ntry again tomorrow\n"


def test_a_record_keeps_the_choices_of_a_run_and_the_name_of_an_open_world() -> None:
    world = ScriptedWorld()
    told = RunOptions(world=world, max_time=5.0, record=Path("run")).recorded()
    assert told["world"] == world.name
    assert told["max_time"] == 5.0
    assert set(told) == {
        *("world", "robot", "max_time", "realtime", "referee", "audit", "faults", "patience"),
        *("goal", "map", "names", "measured_start"),
    }
