"""What goes wrong around a run: a clear sentence, the right exit code, nothing half-written."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

DRIVE = """
momantu_bt: 1
world: four_rooms
main: Drive
trees:
  Drive:
    navigate: {in_front_of: table_b}
"""


def test_ctrl_c_in_mid_motion_brakes_and_reports(tmp_path: Path) -> None:
    tree, report = tmp_path / "drive.yaml", tmp_path / "report.json"
    tree.write_text(DRIVE)
    command = [sys.executable, "-m", "momantu_bt", "run", tree, "--report", report, "--realtime"]
    running = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert running.stdout is not None
    assert running.stdout.readline().startswith("preparing: world ")
    first = running.stdout.readline()
    assert "navigate" in first, first
    time.sleep(3.0)
    running.send_signal(signal.SIGINT)
    said = running.communicate(timeout=60)[0]
    assert running.returncode == 130, said
    assert "Traceback" not in said
    told = json.loads(report.read_text())
    assert told["status"] == "INTERRUPTED"
    assert told["sim_time_s"] > 1.0
    assert any(node["type"] == "navigate" and node["runs"] == 1 for node in told["nodes"])


def test_no_vulkan_is_said_with_the_cure(
    run: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("VK_ICD_FILENAMES", str(tmp_path / "no_driver.json"))
    monkeypatch.setenv("VK_DRIVER_FILES", str(tmp_path / "no_driver.json"))
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path / "empty"))
    done = run("bring_object")
    assert done.code == 3, done.said
    assert "momantu-bt doctor" in done.said
    assert "Traceback" not in done.said
    assert done.report is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["bring_objct"], "did you mean"),
        (["bring_object", "--world", "five_rooms"], "four_rooms"),
        (["bring_object", "--robot", "fetsh"], "fetch"),
        (["bring_object", "--set", "form=table_b"], "did you mean from?"),
        (["bring_object", "--set", "to=table_c"], "table_b"),
        (["bring_object", "--set", "tag_edge=150 kg"], "kg"),
        (["bring_object", "--video", "/nowhere/at/all.mp4"], "no folder"),
        (["bring_object", "--seed", "-1"], "--seed"),
    ],
)
def test_wrong_arguments_are_answered_with_what_would_be_right(
    run: Callable[..., Any], arguments: list[str], words: str
) -> None:
    done = run(*arguments)
    assert done.code == 2, done.said
    assert words in done.said
    assert "Traceback" not in done.said
    assert done.report is None
