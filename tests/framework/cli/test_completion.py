"""Completion in the shell: verbs, options, names, and files where no name fits."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from momantu_bt.cli import main
from momantu_bt.cli.shared.program import COMPLETE


def completions(
    line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> list[str]:
    """What bash is told for a line with the cursor at its end."""
    monkeypatch.setenv(COMPLETE, "complete_bash")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(len(line.split(" ")) - 1))
    assert main([]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    return said.out.split()


@pytest.mark.parametrize(
    ("line", "among"),
    [
        ("momantu-bt ch", {"check"}),
        ("momantu-bt run br", {"bring_object", "bring_object_plain"}),
        ("momantu-bt check bring_object bring", {"bring_object"}),
        ("momantu-bt run x --world f", {"four_rooms"}),
        ("momantu-bt run x --world n", {"none"}),
        ("momantu-bt bench x --robot ki", {"kinova_jackal"}),
        ("momantu-bt run x --fault gripper.s", {"gripper.slips", "gripper.stuck"}),
        ("momantu-bt skills show navi", {"navigate"}),
        ("momantu-bt worlds ch", {"check"}),
        ("momantu-bt worlds check fo", {"four_rooms"}),
        ("momantu-bt robots show fe", {"fetch"}),
        ("momantu-bt faults show camera.d", {"camera.dead"}),
        ("momantu-bt run bring_object --see", {"--seed"}),
    ],
)
def test_what_fits_is_offered(
    line: str,
    among: set[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    offered = completions(line, monkeypatch, capsys)
    assert among <= set(offered)
    assert all(each.startswith(line.split(" ")[-1]) for each in offered)


@pytest.mark.parametrize(
    "line", ["momantu-bt run my_tree.y", "momantu-bt nonsense x", "momantu-bt run 'x"]
)
def test_where_nothing_fits_the_shell_completes_files(
    line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert completions(line, monkeypatch, capsys) == []


def test_files_stand_beside_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bring_it.yaml").touch()
    (tmp_path / "bring.txt").touch()
    (tmp_path / "brook").mkdir()
    offered = completions("momantu-bt run br", monkeypatch, capsys)
    assert offered == ["bring_object", "bring_object_plain", "bring_it.yaml", "brook/"]


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_completes_with_the_script(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["completion", "bash"]) == 0
    program = tmp_path / "momantu-bt"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m momantu_bt "$@"\n')
    program.chmod(0o755)
    script = f"""{capsys.readouterr().out}
PATH={tmp_path}:$PATH COMP_WORDS=(momantu-bt robots show ki) COMP_CWORD=3
_momantu_bt_completion momantu-bt
echo "${{COMPREPLY[@]}}"
"""
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["kinova_jackal"]
