"""`make setup`: nothing to do is quick, every refusal names what to do, versions fit together."""

from __future__ import annotations

import importlib.util
import re
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The set-up script, its .venv in a scratch folder and its commands only noted down."""
    monkeypatch.syspath_prepend(str(ROOT / "setup"))
    spec = importlib.util.spec_from_file_location("environment", ROOT / "setup" / "environment.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    called: list[list[str]] = []

    def call(command: list[str], quiet: bool = False) -> int:
        called.append(command)
        return 1 if any(word in command for word in module.refused) else 0

    class Steps:
        def __init__(self, titles: list[str], log: Path, stream: object) -> None:
            self.titles = list(titles)

        def run(self, *commands: list[str], progress: object = None) -> None:
            self.titles.pop(0)
            if any(call(command) for command in commands):
                raise module.StepFailed("  | no such package\n  log: setup.log")

    (tmp_path / "bin").mkdir()
    monkeypatch.setattr(module, "Steps", Steps)
    monkeypatch.setattr(module, "VENV_PYTHON", tmp_path / "bin" / "python")
    monkeypatch.setattr(module, "STAMP", tmp_path / "stamp")
    monkeypatch.setattr(module, "_call", call)
    module.__dict__.update(called=called, refused=[])
    return module


def installs(environment: ModuleType) -> list[list[str]]:
    """The pip commands among those noted down."""
    return [command for command in environment.called if "install" in command]


def test_the_first_time_installs_and_the_second_does_not(environment: ModuleType) -> None:
    environment.main()
    assert installs(environment)
    environment.VENV_PYTHON.touch()
    environment.called.clear()
    environment.main()
    assert installs(environment) == []


def test_another_version_of_the_projects_files_installs_again(
    environment: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    environment.main()
    environment.VENV_PYTHON.touch()
    environment.called.clear()
    pins = tmp_path / "constraints.txt"
    pins.write_text("opencv-python-headless==1.2\n")
    monkeypatch.setattr(environment, "CONSTRAINTS", pins)
    environment.main()
    assert "opencv-python-headless==1.2" in installs(environment)[-1]


def test_headless_opencv_is_laid_over_the_other_one_last(environment: ModuleType) -> None:
    environment.main()
    last = installs(environment)[-1]
    assert {"--no-deps", "--force-reinstall"} <= set(last)
    assert last[-1].startswith("opencv-python-headless==")


def test_a_failed_install_leaves_no_stamp(environment: ModuleType) -> None:
    environment.refused.append("hatchling")
    with pytest.raises(
        environment.SetupError, match=r"no such package\n.*setup\.log\n.*make setup"
    ):
        environment.main()
    assert not environment.STAMP.exists()


def test_nothing_that_renders_is_no_success(environment: ModuleType) -> None:
    environment.refused.append("momantu_worlds.vulkan.install")
    with pytest.raises(environment.SetupError, match="rendering"):
        environment.main()
    assert environment.STAMP.exists(), "the packages need not be installed again"


@pytest.mark.parametrize("version", [(3, 10, 4), (3, 13, 0)])
def test_an_unsupported_python_is_refused_with_the_cure(
    version: tuple[int, int, int], environment: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "version_info", version)
    with pytest.raises(environment.SetupError, match=r"PYTHON=python3\.11"):
        environment.main()


def test_a_python_without_venv_is_told_what_to_install(environment: ModuleType) -> None:
    environment.refused.append("venv")
    with pytest.raises(environment.SetupError, match="python3-venv"):
        environment.main()


def test_every_dependency_has_a_tested_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [*project["dependencies"]]
    for extra, lines in project["optional-dependencies"].items():
        wanted += [] if extra == "all" else lines
    pins = (ROOT / "constraints.txt").read_text(encoding="utf-8").lower().replace("_", "-")
    names = {re.split(r"[<>=\[]", line)[0] for line in wanted}
    assert {name for name in names if f"\n{name}==" not in pins} == set()
