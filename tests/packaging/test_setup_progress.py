"""The steps of `make setup`: a line each, everything else in the log, which an error names."""

from __future__ import annotations

import importlib.util
import io
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def progress() -> ModuleType:
    spec = importlib.util.spec_from_file_location("progress", ROOT / "setup" / "progress.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def says(text: str, code: int = 0) -> list[str]:
    return [sys.executable, "-c", f"import sys; print({text!r}); sys.exit({code})"]


def test_a_step_is_one_line_and_the_log_has_the_rest(progress: ModuleType, tmp_path: Path) -> None:
    shown, log = io.StringIO(), tmp_path / "build" / "setup.log"
    steps = progress.Steps(["first", "second"], log, shown)
    steps.run(says("hundreds of lines"), says("and more"))
    steps.run(says("the last"))
    lines = shown.getvalue().splitlines()
    assert [line[:12] for line in lines] == ["  1/2 first ", "  2/2 second"]
    kept = log.read_text()
    assert all(text in kept for text in ("hundreds of lines", "and more", "the last"))


def test_an_error_repeats_the_last_lines_and_names_the_log(
    progress: ModuleType, tmp_path: Path
) -> None:
    shown, log = io.StringIO(), tmp_path / "setup.log"
    steps = progress.Steps(["packages"], log, shown)
    with pytest.raises(progress.StepFailed, match=r"no such version(?s:.*)setup\.log"):
        steps.run(says("no such version", code=1), says("never run"))
    assert "failed" in shown.getvalue()
    assert "never run" not in log.read_text()


def test_pips_lines_say_how_far_it_is(progress: ModuleType, tmp_path: Path) -> None:
    pip = progress.Progress(tmp_path, expected=150)
    for line in (
        "Collecting lxml>=6.0 (from momantu-bt==0.1.0)\n",
        "  Downloading lxml-6.0.whl.metadata (3.6 kB)\n",
        "Requirement already satisfied: pip in x\n",
        "Downloading torch-2.13.0-cp311.whl (812.5 MB)\n",
    ):
        pip.read(line)
    assert pip.text() == "2 of about 150 found, 812 MB downloaded"
    pip.read("Installing collected packages: lxml, torch\n")
    assert pip.text() == "0 of 2 installed"
    (tmp_path / "lxml-6.0.dist-info").mkdir()
    assert pip.text() == "1 of 2 installed"
